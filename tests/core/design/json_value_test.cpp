// SPDX-License-Identifier: GPL-3.0-or-later
// The reader of JSON names the path of a wrong value and the line of a wrong text.
#include "triskin/design/json_value.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "triskin/base/error.hpp"

namespace triskin::design {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string error_of_text(const std::string& text) {
  try {
    (void)parse_json(text, "f.json");
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

TEST(JsonText, is_read_as_the_library_reads_it) {
  const std::string text = R"({"a":[1,-2,3.5,18446744073709551615,true,null,"x"],"b":{"c":[]}})";
  EXPECT_EQ(parse_json(text, "f.json"), nlohmann::json::parse(text));
}

TEST(JsonText, a_syntax_error_names_the_line) {
  EXPECT_THAT(error_of_text("{\n\"a\":1,\n}"), StartsWith("f.json: is not JSON: line 3, column 1: "));
  EXPECT_THAT(error_of_text("{\"a\":[1,\n2"), HasSubstr("line 2"));
  EXPECT_THAT(error_of_text("{\"a\":\n1e999}"), StartsWith("f.json: is not JSON: line 2: a number is out of range"));
}

// RFC 6901: ~ is written ~0 and / is written ~1; elements are counted from 0, whatever stands before them.
TEST(JsonText, a_repeated_key_names_the_path_of_its_object) {
  EXPECT_EQ(error_of_text(R"({"a":1,"a":2})"),
            "f.json: top level: key \"a\" appears twice in one object; leave one out");
  EXPECT_THAT(error_of_text(R"({"x":[7,[8],{"y":{"k":1,"k":1}}]})"),
              HasSubstr("f.json: /x/2/y: key \"k\" appears twice"));
  EXPECT_THAT(error_of_text(R"({"a/b~":{"k":1,"k":1}})"), HasSubstr("/a~1b~0: "));
  EXPECT_EQ(error_of_text(R"([{"k":1},{"k":1}])"), "");
}

TEST(JsonText, may_be_64_levels_deep) {
  EXPECT_EQ(error_of_text(std::string(64, '[') + std::string(64, ']')), "");
  EXPECT_THAT(error_of_text(std::string(65, '[') + std::string(65, ']')), HasSubstr("nested deeper than 64"));
  EXPECT_THAT(error_of_text(std::string(1'000'000, '[')), HasSubstr("nested deeper than 64"));
}

TEST(JsonValue, every_error_names_the_path) {
  const nlohmann::json document = {{"covers", {{{"pose", 1}}, {{"pose", {0.5, "x"}}}}}, {"a/b", "text"}};
  const JsonValue v(document, "f.json");
  const auto error_of = [](auto&& use) -> std::string {
    try {
      use();
    } catch (const InputError& e) {
      return e.what();
    }
    return {};
  };
  EXPECT_EQ(error_of([&] { (void)v["covers"].at(1)["pose"].at(1).number(); }),
            "f.json: /covers/1/pose/1: must be a number");
  EXPECT_EQ(error_of([&] { (void)v["covers"].at(2); }), "f.json: /covers: must be an array with an element 2");
  EXPECT_EQ(error_of([&] { (void)v["covers"].at(0)["name"]; }), "f.json: /covers/0: key \"name\" is missing");
  EXPECT_EQ(error_of([&] { (void)v["a/b"].boolean(); }), "f.json: /a~1b: must be true or false");
  EXPECT_EQ(error_of([&] { (void)v["covers"].at(0)["pose"].integer(2, 3); }),
            "f.json: /covers/0/pose: must be in 2 … 3");
  EXPECT_EQ(error_of([&] { v.fail("is odd"); }), "f.json: top level: is odd");
  EXPECT_EQ(v["covers"].at(0)["pose"].integer(0, 1), 1);
}

}  // namespace
}  // namespace triskin::design
