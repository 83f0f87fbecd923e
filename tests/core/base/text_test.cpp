// SPDX-License-Identifier: GPL-3.0-or-later
// Text of a file must be safe in each format into which it is written.
#include <gtest/gtest.h>

#include "triskin/base/csv_field.hpp"
#include "triskin/base/markup.hpp"
#include "triskin/base/terminal_text.hpp"

namespace triskin {
namespace {

TEST(EscapeMarkup, leaves_no_character_that_could_end_a_text_or_an_attribute) {
  EXPECT_EQ(escape_markup("arm"), "arm");
  EXPECT_EQ(escape_markup("</title><script>alert('1')&\""),
            "&lt;/title&gt;&lt;script&gt;alert(&#39;1&#39;)&amp;&quot;");
  EXPECT_EQ(escape_markup("Größe 5 µm"), "Größe 5 µm");
}

// By XML 1.0, section 2.2, these have no representation in a document, not even as a reference.
TEST(EscapeMarkup, replaces_what_xml_cannot_hold) {
  EXPECT_EQ(escape_markup(std::string_view("a\0b", 3)),
            "a\xEF\xBF\xBD"
            "b");
  EXPECT_EQ(escape_markup("\x1B[2J"), "\xEF\xBF\xBD[2J");
  EXPECT_EQ(escape_markup("\xC2\x85"), "\xEF\xBF\xBD");
  EXPECT_EQ(escape_markup("\xEF\xBF\xBE"), "\xEF\xBF\xBD");
  EXPECT_EQ(escape_markup("\xFF\xFE"), "\xEF\xBF\xBD\xEF\xBF\xBD");
  EXPECT_EQ(escape_markup("tab\tline\n"), "tab&#9;line&#10;");
}

// RFC 3629 allows sequences of 1 to 4 bytes, no overlong form, no surrogate, nothing above U+10FFFF.
TEST(Utf8, takes_what_rfc_3629_allows_and_nothing_else) {
  EXPECT_EQ(utf8_at("$", 0).code, U'$');
  EXPECT_EQ(utf8_at("\xC2\xA3", 0).code, U'\u00A3');
  EXPECT_EQ(utf8_at("\xE2\x82\xAC", 0).code, U'\u20AC');
  EXPECT_EQ(utf8_at("\xF0\x90\x8D\x88", 0).code, U'\U00010348');
  for (const char* wrong : {"\x80", "\xC0\x80", "\xC1\xBF", "\xE0\x80\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xC2",
                            "\xE2\x82", "\xF8\x88\x80\x80\x80", "\xC2\x41"})
    EXPECT_EQ(utf8_at(wrong, 0).bytes, 0U) << wrong;
}

TEST(ForTerminal, shows_controls_instead_of_obeying_them) {
  EXPECT_EQ(for_terminal("arm: 3 mm\n\tok"), "arm: 3 mm\n\tok");
  EXPECT_EQ(for_terminal("\x1B]0;owned\x07"), "\\x1B]0;owned\\x07");
  EXPECT_EQ(for_terminal("line\rhidden\b\x7F"), "line\\x0Dhidden\\x08\\x7F");
  EXPECT_EQ(for_terminal("\xC2\x9B"), "\\x9B");
  EXPECT_EQ(for_terminal("a\xE2\x80\xAE"
                         "b\xE2\x81\xA6"),
            "a\\u202Eb\\u2066");
  EXPECT_EQ(for_terminal("\xFF"), "\\xFF");
  EXPECT_EQ(for_terminal("µ … 漢"), "µ … 漢");
}

// The rules are numbers 5 to 7 of RFC 4180, section 2.
TEST(CsvField, is_one_field_whatever_it_holds) {
  EXPECT_EQ(csv_field("soft"), "soft");
  EXPECT_EQ(csv_field("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_field("say \"x\""), "\"say \"\"x\"\"\"");
  EXPECT_EQ(csv_field("a\r\nb"), "\"a\r\nb\"");
  EXPECT_EQ(csv_field(" a"), "\" a\"");
  EXPECT_EQ(csv_field("=HYPERLINK(1)"), "'=HYPERLINK(1)");
  EXPECT_EQ(csv_field("@a,b"), "\"'@a,b\"");
  EXPECT_EQ(csv_field(""), "");
}

}  // namespace
}  // namespace triskin
