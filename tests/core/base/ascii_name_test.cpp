// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/ascii_name.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace triskin {
namespace {

TEST(AsciiName, keeps_plain_names) {
  EXPECT_EQ(ascii_name("forearm_2", "", "part"), "forearm_2");
  EXPECT_EQ(ascii_name("left-arm.2", "-.", "part"), "left-arm.2");
  EXPECT_EQ(ascii_name("", "", "part"), "part");
}

// The digits are of FNV-1a as another program computed it. "left arm" and "left_arm" are two covers.
TEST(AsciiName, tells_apart_what_it_spells_alike) {
  EXPECT_EQ(ascii_name("left arm", "", "part"), "left_arm_6c1880ca");
  EXPECT_EQ(ascii_name("left arm-2", "", "part"), "left_arm_2_4148deb5");
  EXPECT_EQ(ascii_name("left arm-2.1", "-.", "part"), "left_arm-2.1_6f2f7590");
  std::set<std::string> names;
  for (const char* text : {"left arm", "left_arm", "left-arm", "left.arm", "left/arm", "left_arm_6c1880ca",
                           "left_arm_6C1880CA", "left arm_6c1880ca", "_6c1880ca"})
    EXPECT_TRUE(names.insert(ascii_name(text, "", "part")).second) << text;
}

// By hand: (811c9dc5 ^ 22) * 01000193 modulo 2^32.
TEST(AsciiName, tells_apart_what_it_cannot_spell) {
  EXPECT_EQ(ascii_name("\"", "", "part"), "__270c92a5");
  std::set<std::string> names;
  const char* const scripts[] = {"左腕", "右腕", "Überarm", "Ùberarm", "рука",    "рукá",
                                 "ذراع", "ذراغ", "🦾",      "🦿",      "a \"b\"", "a \"b'"};
  for (const char* text : scripts) {
    const std::string name = ascii_name(text, "", "part");
    EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_"),
              std::string::npos);
    EXPECT_TRUE(names.insert(name).second) << text << " -> " << name;
  }
}

// What the bridge is given is a name already: it is not spelled a second time.
TEST(PartName, stands_as_it_is) {
  for (const char* text : {"左腕", "left arm", "2nd", "arm_20261129", "_"})
    EXPECT_TRUE(is_part_name(part_name(text))) << text;
  EXPECT_TRUE(is_part_name("arm_20261129"));
  for (const char* text : {"", "left arm", "2nd", "左腕", "a/b"}) EXPECT_FALSE(is_part_name(text)) << text;
}

}  // namespace
}  // namespace triskin
