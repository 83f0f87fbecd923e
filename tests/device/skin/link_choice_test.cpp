// SPDX-License-Identifier: GPL-3.0-or-later
// If several settings name a link, program and library must choose the same one, by the same function.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "triskin/connect/open_link.hpp"

namespace triskin::skin {
namespace {

class LinkChoice : public testing::Test {
 protected:
  LinkChoice() { ::unsetenv("TRISKIN_LINK"); }
  ~LinkChoice() override { ::unsetenv("TRISKIN_LINK"); }
  static std::string link(bool chosen, bool simulates) {
    connect::LinkOptions options;
    options.link = chosen ? "usb" : "";
    options.chosen = chosen;
    connect::settle_link(options, simulates);
    return options.link;
  }
};

TEST_F(LinkChoice, what_is_named_goes_before_all) {
  ::setenv("TRISKIN_LINK", "can:can0", 1);
  EXPECT_EQ(link(true, false), "usb");
  EXPECT_EQ(link(true, true), "usb");
}

TEST_F(LinkChoice, a_scene_goes_before_the_environment) {
  ::setenv("TRISKIN_LINK", "can:can0", 1);
  EXPECT_EQ(link(false, true), "sim");
}

TEST_F(LinkChoice, the_environment_is_used_where_nothing_else_says_it) {
  ::setenv("TRISKIN_LINK", "can:can0", 1);
  EXPECT_EQ(link(false, false), "can:can0");
}

TEST_F(LinkChoice, without_any_there_is_none) {
  EXPECT_EQ(link(false, false), "");
}

}  // namespace
}  // namespace triskin::skin
