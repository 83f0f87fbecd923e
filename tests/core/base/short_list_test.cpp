// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/short_list.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace triskin {
namespace {

TEST(ShortList, NamesTheFirstAndCountsTheOthers) {
  EXPECT_EQ(short_list(std::vector<int>{}), "");
  EXPECT_EQ(short_list(std::vector{3, 7}, 2), "3, 7");
  EXPECT_EQ(short_list(std::vector{3, 7, 12, 5}, 2), "3, 7 and 2 more");
  EXPECT_EQ(short_list(std::vector<std::string>(13, "a")).substr(30), "a, a and 1 more");
}

}  // namespace
}  // namespace triskin
