// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/format_index.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "triskin/layout/index.hpp"

namespace triskin {
namespace {

using layout::ModuleId;
using layout::PatchIndex;
using layout::TableRow;

TEST(FormatIndex, writes_the_integer_with_its_specification) {
  EXPECT_EQ(fmt::format("row {} of patch {:>3}", TableRow{12}, PatchIndex{7}), "row 12 of patch   7");
  EXPECT_EQ(fmt::format("{}", fmt::join(std::vector{TableRow{1}, TableRow{2}}, ", ")), "1, 2");
  EXPECT_EQ(fmt::format("{}", PatchIndex::none()), "-1");
}

TEST(FormatIndex, json_has_the_integer) {
  const nlohmann::json j = {{"row", TableRow{12}}, {"patches", std::vector{PatchIndex{0}, PatchIndex{3}}}};
  EXPECT_EQ(j.dump(), R"({"patches":[0,3],"row":12})");
}

TEST(FormatIndex, concerns_indices_alone) {
  EXPECT_TRUE(IndexKind<PatchIndex>);
  EXPECT_FALSE(IndexKind<ModuleId>) << "what people read is its number";
  EXPECT_FALSE((std::is_constructible_v<nlohmann::json, ModuleId>));
  EXPECT_FALSE(IndexKind<int>);
  EXPECT_FALSE(IndexKind<std::vector<int>>);
}

}  // namespace
}  // namespace triskin
