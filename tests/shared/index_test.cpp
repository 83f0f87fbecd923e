// SPDX-License-Identifier: Apache-2.0
#include "triskin/layout/index.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <map>
#include <sstream>
#include <unordered_set>
#include <vector>

namespace triskin::layout {
namespace {

// Stands for an interface with two kinds of numbers.
int counts_at(ModuleId module, TaxelIndex taxel) {
  return 100 * module + taxel;
}

template <class... Arguments>
concept CanAsk = requires(Arguments... arguments) { counts_at(arguments...); };
template <class Left, class Right>
concept CanCompare = requires(Left left, Right right) { left == right; };
template <class Left, class Right>
concept CanOrder = requires(Left left, Right right) { left < right; };
template <class To, class From>
concept CanAssign = requires(To to, From from) { to = from; };

TEST(Index, ExchangedOrPlainArgumentsDoNotCompile) {
  EXPECT_TRUE((CanAsk<ModuleId, TaxelIndex>));
  EXPECT_FALSE((CanAsk<TaxelIndex, ModuleId>));
  EXPECT_FALSE((CanAsk<PatchIndex, TaxelIndex>));
  EXPECT_FALSE((CanAsk<int, TaxelIndex>));
  EXPECT_FALSE((CanAsk<ModuleId, int>));
  EXPECT_EQ(counts_at(ModuleId{3}, TaxelIndex{7}), 307);
}

TEST(Index, IsNeitherMadeOfNorAssignedFromAnotherKind) {
  EXPECT_FALSE((std::is_constructible_v<PatchIndex, ModuleId>));
  EXPECT_FALSE((std::is_convertible_v<ModuleId, PatchIndex>));
  EXPECT_FALSE((CanAssign<PatchIndex&, ModuleId>));
  EXPECT_FALSE((std::is_constructible_v<ModuleId, bool>));
  EXPECT_FALSE((std::is_constructible_v<ModuleId, double>));
  EXPECT_TRUE((std::is_constructible_v<ModuleId, ModuleId>));
}

TEST(Index, IsMadeOfAnIntegerOnlyExplicitly) {
  EXPECT_FALSE((std::is_convertible_v<int, ModuleId>));
  EXPECT_FALSE((CanAssign<ModuleId&, int>));
  EXPECT_TRUE((std::is_constructible_v<ModuleId, int>));
  EXPECT_TRUE((std::is_constructible_v<ModuleId, std::size_t>));
  EXPECT_TRUE((std::is_constructible_v<TableRow, std::uint8_t>));
  EXPECT_EQ(ModuleId{std::size_t{9}}, 9);
}

TEST(Index, ConvertsToItsIntegerWithoutAWord) {
  EXPECT_TRUE((std::is_convertible_v<ModuleId, int>));
  const std::array<int, 3> values{10, 20, 30};
  const ModuleId module{2};
  EXPECT_EQ(values[static_cast<std::size_t>(module)], 30);
  EXPECT_EQ(module + 1, 3);
  const int plain = module;
  EXPECT_EQ(plain, 2);
}

TEST(Index, ComparesWithItsOwnKindAndWithIntegersOnly) {
  EXPECT_TRUE((CanCompare<ModuleId, ModuleId>));
  EXPECT_TRUE((CanCompare<ModuleId, int>));
  EXPECT_FALSE((CanCompare<ModuleId, PatchIndex>));
  EXPECT_TRUE((CanOrder<ModuleId, ModuleId>));
  EXPECT_TRUE((CanOrder<ModuleId, int>));
  EXPECT_FALSE((CanOrder<ModuleId, PatchIndex>));
  EXPECT_LT(ModuleId{2}, ModuleId{3});
  EXPECT_NE(ModuleId{2}, ModuleId{3});
  EXPECT_GE(ModuleId{2}, 0);
}

TEST(Index, HasAValueForNone) {
  EXPECT_EQ(PatchIndex::none(), -1);
  EXPECT_EQ(PatchIndex{}, 0);
}

TEST(Index, CountsUp) {
  std::vector<int> seen;
  for (ModuleId module; module < 3; ++module) seen.push_back(module);
  EXPECT_EQ(seen, (std::vector{0, 1, 2}));
}

TEST(Index, IsAKeyOfMapsAndSets) {
  std::map<PatchIndex, int> by_patch{{PatchIndex{4}, 40}, {PatchIndex{1}, 10}};
  EXPECT_EQ(by_patch.begin()->first, 1);
  const std::unordered_set<ModuleId> modules{ModuleId{5}, ModuleId{5}, ModuleId{6}};
  EXPECT_EQ(modules.size(), 2U);
  EXPECT_TRUE(modules.contains(ModuleId{6}));
}

TEST(Index, IsPrintedAsItsInteger) {
  std::ostringstream text;
  text << NodeAddress{65} << ' ' << ModuleId::none();
  EXPECT_EQ(text.str(), "65 -1");
}

}  // namespace
}  // namespace triskin::layout
