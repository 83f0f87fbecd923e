// SPDX-License-Identifier: GPL-3.0-or-later
// These tests check that a text reads the same from every editor, and that JSON errors use our own words.
#include "triskin/base/text_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "triskin/base/json_cause.hpp"

namespace triskin {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(PlainText, is_the_same_with_the_line_ends_of_every_system) {
  EXPECT_EQ(plain_text("a\nb\n"), "a\nb\n");
  EXPECT_EQ(plain_text("a\r\nb\r\n"), "a\nb\n");
  EXPECT_EQ(plain_text("a\rb\r"), "a\nb\n");
  EXPECT_EQ(plain_text("a\r\nb\rc\nd"), "a\nb\nc\nd");
  EXPECT_EQ(plain_text("a\r\r\nb\n\rc"), "a\n\nb\n\nc");
  EXPECT_EQ(plain_text(""), "");
}

TEST(PlainText, has_no_byte_order_mark_and_is_utf8) {
  EXPECT_EQ(plain_text("\xEF\xBB\xBF{}"), "{}");
  EXPECT_EQ(plain_text(std::string("\xFF\xFE{\0}\0", 6)), "{}");
  EXPECT_EQ(plain_text(std::string("\xFE\xFF\0{\0}", 6)), "{}");
  EXPECT_EQ(plain_text(std::string("{\0 \0}\0", 6)), "{ }");
  EXPECT_EQ(plain_text("\xC2\xB5\xFF"), "\xC2\xB5\xFF");  // Damaged bytes stay, so that the reader finds them.
}

// The text has the euro sign, U+10348 as the pair D800 DF48 (Unicode 3.9, table 3-4), and half of a pair alone.
TEST(PlainText, utf16_beyond_the_basic_plane) {
  EXPECT_EQ(without_utf16(std::string("\xFF\xFE\xAC\x20\x00\xD8\x48\xDF", 8)), "\xE2\x82\xAC\xF0\x90\x8D\x88");
  EXPECT_EQ(without_utf16(std::string("\xFF\xFE\x00\xD8\x41\x00", 6)), "\xEF\xBF\xBD\x41");
}

TEST(OpenLine, is_said_of_a_text_without_a_last_line_end) {
  EXPECT_EQ(note_of_open_line("1,2\n", "a.csv"), "");
  EXPECT_EQ(note_of_open_line("", "a.csv"), "");
  EXPECT_THAT(note_of_open_line("1,2\n3,4", "a.csv"), HasSubstr("a.csv: ends without a line end"));
}

std::string cause_of(const std::string& text) {
  try {
    [[maybe_unused]] const auto parsed = nlohmann::json::parse(text);
  } catch (const nlohmann::json::exception& e) {
    return json_cause(e.what());
  }
  return {};
}

TEST(JsonCause, says_place_and_cause_in_our_words) {
  EXPECT_EQ(cause_of("{\n  \"a\": 1\n"),
            "line 3, column 1: the text ends in the middle: it was cut, or a bracket is missing");
  EXPECT_THAT(cause_of("[nan]"), HasSubstr("JSON has no nan and no inf"));
  EXPECT_THAT(cause_of("[1.]"), HasSubstr("a malformed number"));
  EXPECT_THAT(cause_of("[1e999]"), HasSubstr("a number is out of range"));
  EXPECT_THAT(cause_of("[1,]"), HasSubstr("line 1, column 4: unexpected ']'"));
  EXPECT_THAT(cause_of("[1] 2"), HasSubstr("more follows behind the end"));
  EXPECT_THAT(cause_of("[\"a\n\"]"), HasSubstr("a closing quote is missing"));
  EXPECT_THAT(cause_of("[\"\xFF\"]"), HasSubstr("not UTF-8"));
  EXPECT_THAT(cause_of("[\"\\x\"]"), HasSubstr("a backslash"));
  EXPECT_THAT(cause_of("\"a"), HasSubstr("never closed"));
}

TEST(JsonCause, says_what_is_wrong_with_a_value) {
  const nlohmann::json object = {{"a", "text"}};
  const auto cause = [&](auto&& use) -> std::string {
    try {
      use();
    } catch (const nlohmann::json::exception& e) {
      return json_cause(e.what());
    }
    return {};
  };
  EXPECT_EQ(cause([&] { (void)object.at("b"); }), "the key \"b\" is missing");
  EXPECT_EQ(cause([&] { (void)object.at("a").get<int>(); }), "a value is of another type than it should be");
  EXPECT_EQ(cause([&] { (void)nlohmann::json::array({1}).at(3); }), "a list is too short");
}

// The message must not contain the library's own words or damaged bytes.
TEST(JsonCause, no_message_of_the_library_comes_through) {
  const std::string whole = R"({"a":[1.5,-2e3,true,null],"b":{"c":"d\u00e9"}})";
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const char with : std::string("{}[],:\"\\x0-.\n\xFF\x01", 15)) {
      std::string text = whole;
      text[at] = with;
      const std::string cause = cause_of(text);
      for (const char* raw : {"exception", "syntax error", "last read", "parse error", "literal;", "\xFF", "\x01"})
        ASSERT_THAT(cause, Not(HasSubstr(raw))) << text;
    }
    ASSERT_THAT(cause_of(whole.substr(0, at)), Not(HasSubstr("last read"))) << at;
  }
}

}  // namespace
}  // namespace triskin
