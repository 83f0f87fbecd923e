// SPDX-License-Identifier: GPL-3.0-or-later
// Removes, adds, keeps and mirrors modules: the rest must stay, and the result must keep every rule.
#include "triskin/pipeline/edit_design.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <numeric>
#include <set>

#include "support/covers.hpp"
#include "support/flat_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::pipeline {
namespace {

namespace fs = std::filesystem;
using design::Design;
using design::kHeight_mm;
using design::Tile;
using design::Vec3;

// Returns the rules that a design breaks according to `triskin check`.
std::vector<std::string> broken_by(const Design& d) {
  const fs::path file = fs::temp_directory_path() / ("edit_design." + std::to_string(::getpid()) + ".json");
  design::write_design(file, d);
  std::vector<std::string> broken;
  for (const check::Violation& v : check::check_design(file).violations)
    broken.push_back(v.rule + ": " + v.where + ": " + v.text);
  fs::remove(file);
  return broken;
}
using Nothing = std::vector<std::string>;

void expect_where_they_stood(const Design& before, const EditedDesign& e) {
  ASSERT_EQ(e.new_id.size(), before.layout.modules.size());
  std::set<int> ids(e.added.begin(), e.added.end());
  for (std::size_t id = 0; id < e.new_id.size(); ++id) {
    if (e.new_id[id] < 0) continue;
    EXPECT_TRUE(ids.insert(e.new_id[id]).second) << id;
    const auto& now = e.design.layout.modules.at(static_cast<std::size_t>(e.new_id[id]));
    EXPECT_EQ(now.corner_mm, before.layout.modules[id].corner_mm) << id;
    EXPECT_EQ(now.tile, before.layout.modules[id].tile) << id;
  }
  EXPECT_EQ(ids.size(), e.design.layout.modules.size());
}

// Five of the six triangles around the lattice point (1, 1), which lies at (45, h), are on a plate; number 4 is
// missing. Tiles run counter-clockwise from the right; the plate ends 1 mm beside them.
const std::vector<Tile> kRing{{1, 1, true}, {0, 1, false}, {0, 1, true}, {0, 0, false}, {1, 0, true}, {1, 0, false}};
constexpr std::size_t kMissing = 4;

Design ring() {
  Design d = test::flat_design("ring", {14, -1}, {76, 2 * kHeight_mm + 1});
  std::vector<Tile> tiles = kRing;
  tiles.erase(tiles.begin() + kMissing);
  std::map<Tile, int> number;
  for (const Tile& t : tiles) number.emplace(t, static_cast<int>(number.size()));
  for (std::size_t k = 0; k < tiles.size(); ++k) number[tiles[k]] = static_cast<int>(k);
  test::lay_modules(d, tiles, number);
  return edit_design(d, {}).design;  // The result is measured and wired.
}

std::string error_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

TEST(EditDesign, removes_modules_and_parts_islands) {
  const Design before = ring();
  EXPECT_EQ(broken_by(before), Nothing{});
  ASSERT_EQ(before.layout.modules.size(), 5U);
  EXPECT_EQ(before.layout.islands, 1);
  // Modules 0 … 3 are connected in this order, and 4 to 0; without 1 and 2, module 3 is alone.
  const EditedDesign e = edit_design(before, {{2, 1, 2}, {}});
  EXPECT_EQ(e.new_id, (std::vector{0, -1, -1, 1, 2}));
  EXPECT_TRUE(e.added.empty());
  EXPECT_EQ(e.design.layout.islands, 2);
  EXPECT_EQ(e.design.layout.modules[0].island, 0);
  EXPECT_EQ(e.design.layout.modules[1].island, 1);
  EXPECT_EQ(e.design.layout.modules[2].island, 0);
  expect_where_they_stood(before, e);
  EXPECT_EQ(broken_by(e.design), Nothing{});
  EXPECT_NE(e.design.design_id, before.design_id);
}

Design read_back(const Design& d) {
  const fs::path file = fs::temp_directory_path() / ("edit_numbers." + std::to_string(::getpid()) + ".json");
  design::write_design(file, d);
  Design again = design::read_intact_design(file);
  fs::remove(file);
  return again;
}

using Numbers = std::vector<int>;
Numbers numbers_of(const Design& d) {
  return design::all_numbers(d.layout);
}

// Labels and printed sheets name the modules that stay, and no module gets the label of one that is gone.
TEST(EditDesign, NumbersOfModulesThatStayHold) {
  const Design before = ring();
  EXPECT_EQ(numbers_of(before), (Numbers{0, 1, 2, 3, 4}));
  const EditedDesign removed = edit_design(before, {{1}, {}});
  EXPECT_EQ(removed.new_id, (std::vector{0, -1, 1, 2, 3}));
  EXPECT_EQ(numbers_of(removed.design), (Numbers{0, 2, 3, 4}));
  expect_where_they_stood(before, removed);
  EXPECT_EQ(broken_by(removed.design), Nothing{});
  const EditedDesign replaced = edit_design(before, {{1}, {TileOfIsland{0, kRing[kMissing]}}});
  EXPECT_EQ(replaced.added, std::vector{4});
  EXPECT_EQ(numbers_of(replaced.design), (Numbers{0, 2, 3, 4, 5}));
  expect_where_they_stood(before, replaced);
  EXPECT_EQ(broken_by(replaced.design), Nothing{});
  // Number 5 was given; when its module goes, the next one is 6, also after the file was read.
  const Design without = read_back(edit_design(read_back(replaced.design), {{4}, {}}).design);
  EXPECT_EQ(numbers_of(without), (Numbers{0, 2, 3, 4}));
  EXPECT_EQ(broken_by(without), Nothing{});
  const Design again = edit_design(without, {{}, {TileOfIsland{0, kRing[kMissing]}}}).design;
  EXPECT_EQ(numbers_of(again), (Numbers{0, 2, 3, 4, 6}));
  EXPECT_EQ(read_back(again).layout.modules.back().neighbour, again.layout.modules.back().neighbour);
  EXPECT_EQ(numbers_of(mirror_design(again, {Vec3::UnitY(), 0.0}).design), numbers_of(again));
}

TEST(EditDesign, NumbersEnd) {
  Design d = ring();
  d.next_number = design::kMaxModuleNumber;
  d = edit_design(d, {{}, {TileOfIsland{0, kRing[kMissing]}}}).design;
  EXPECT_EQ(numbers_of(d), (Numbers{0, 1, 2, 3, 4, 65'535}));
  EXPECT_EQ(broken_by(d), Nothing{});
  d = read_back(edit_design(d, {{5}, {}}).design);
  EXPECT_NE(error_of([&] { (void)edit_design(d, {{}, {TileOfIsland{0, kRing[kMissing]}}}); }).find("end at 65535"),
            std::string::npos);
  d.kinds.kinds.push_back({"soft", 6, "felt", 0.0});
  d.next_number = design::kMaxModuleNumberWithKinds + 1;
  EXPECT_NE(error_of([&] {
              (void)edit_design(d, {{}, {TileOfIsland{0, kRing[kMissing]}}});
            }).find("end at 8191 where there are kinds"),
            std::string::npos);
}

// Messages name modules by number: with 1 gone, module 4 has id 3 and module 2 id 1.
TEST(EditDesign, MessagesNameNumbers) {
  const Design d = edit_design(ring(), {{1}, {}}).design;
  EXPECT_NE(error_of([&] {
              (void)edit_design(d, {{}, {BesideModule{2, 1}}});
            }).find("module 3 has no free side 1: module 2 is joined there"),
            std::string::npos);
}

// The layout of an alternative: a module that stands where one stood has its number, wherever it is in the list.
TEST(EditDesign, AnAlternativeKeepsTheNumbersOfItsModules) {
  Design d = edit_design(ring(), {{1}, {TileOfIsland{0, kRing[kMissing]}}}).design;  // 0 2 3 4 5
  design::Alternative other;
  other.layout = edit_design(d, {{0}, {}}).design.layout;
  other.layout.jumpers.clear();
  std::swap(other.layout.modules[0], other.layout.modules[3]);
  for (auto& m : other.layout.modules)
    for (int& n : m.neighbour) n = n == 0 ? 3 : n == 3 ? 0 : n;
  other.layout.numbers.clear();
  d.alternatives = {other};
  const Design taken = take_alternative(d, 0);
  EXPECT_EQ(numbers_of(taken), (Numbers{2, 3, 4, 5}));
  EXPECT_EQ(taken.layout.modules[3].corner_mm, d.layout.modules[4].corner_mm);
  EXPECT_EQ(broken_by(taken), Nothing{});
  for (auto& m : d.alternatives[0].layout.modules)
    for (Vec3& c : m.corner_mm) c.x() += 0.25;
  EXPECT_EQ(numbers_of(take_alternative(d, 0)), (Numbers{6, 7, 8, 9}));  // 5 is the highest that was given.
}

TEST(EditDesign, adds_the_module_that_closes_a_ring) {
  const Design before = ring();
  // Module 3 is the down tile (0, 0): its side 0 leads to the up tile (1, 0), whose side 1 leads to module 4.
  for (const NewPlace place : {NewPlace{BesideModule{3, 0}}, NewPlace{TileOfIsland{0, kRing[kMissing]}}}) {
    const EditedDesign e = edit_design(before, {{}, {place}});
    ASSERT_EQ(e.added, std::vector{5});
    const auto& m = e.design.layout.modules[5];
    EXPECT_EQ(m.tile, kRing[kMissing]);
    const std::array<Vec3, 3> wanted{Vec3(30, 0, 0), Vec3(60, 0, 0), Vec3(45, kHeight_mm, 0)};
    for (std::size_t c = 0; c < 3; ++c) EXPECT_LT((m.corner_mm[c] - wanted[c]).norm(), 1e-6) << c;
    EXPECT_EQ(m.neighbour, (std::array{-1, 4, 3}));
    expect_where_they_stood(before, e);
    EXPECT_EQ(broken_by(e.design), Nothing{});
  }
}

TEST(EditDesign, a_tile_may_hang_on_one_that_was_just_added) {
  // Modules 0, 1, 2 remain: tiles 0, 1 and 5 of the ring.
  const Design before = edit_design(ring(), {{2, 3}, {}}).design;
  const EditedDesign e =
      edit_design(before, {{}, {TileOfIsland{0, kRing[2]}, TileOfIsland{0, kRing[3]}, BesideModule{2, 2}}});
  EXPECT_EQ(e.added, (std::vector{3, 4, 5}));
  EXPECT_EQ(e.design.layout.islands, 1);
  EXPECT_EQ(broken_by(e.design), Nothing{});
}

TEST(EditDesign, names_the_limit_that_forbids_a_module) {
  const Design d = ring();
  // Module 0 is the up tile (1, 1): the plate ends 1 mm beyond its side 1.
  const std::string over = error_of([&] { (void)edit_design(d, {{}, {BesideModule{0, 1}}}); });
  EXPECT_NE(
      over.find("No module fits at side 1 of module 0, even shifted slightly: it would stick out past an edge by"),
      std::string::npos)
      << over;
  EXPECT_NE(error_of([&] { (void)edit_design(d, {{}, {BesideModule{3, 1}}}); }).find("module 2 is joined there"),
            std::string::npos);
  EXPECT_NE(error_of([&] { (void)edit_design(d, {{9}, {}}); }).find("there is no module 9; the design has 0 … 4"),
            std::string::npos);
  EXPECT_NE(error_of([&] { (void)edit_design(d, {{3}, {BesideModule{3, 0}}}); }).find("module 3 is removed"),
            std::string::npos);
  EXPECT_NE(error_of([&] { (void)edit_design(d, {{}, {TileOfIsland{0, {7, 7, true}}}}); }).find("beside no free side"),
            std::string::npos);
  EXPECT_NE(
      error_of([&] { (void)edit_design(d, {{}, {TileOfIsland{0, kRing[2]}}}); }).find("filled: module 2 is there"),
      std::string::npos);
  EXPECT_NE(error_of([&] { (void)edit_design(d, {{0, 1, 2, 3, 4}, {}}); }).find("no module would be left"),
            std::string::npos);
  // At a slit the tile across is taken, though no joint is there.
  Design slit = d;
  slit.layout.modules[0].neighbour[2] = slit.layout.modules[1].neighbour[0] = -1;
  EXPECT_NE(error_of([&] { (void)edit_design(slit, {{}, {BesideModule{1, 0}}}); }).find("lies at a slit: module 0"),
            std::string::npos);
}

TEST(EditDesign, kinds_go_with_their_modules_and_are_checked) {
  Design d = ring();
  d.kinds.kinds = {{"soft", 12, "foam", 80.0}};
  // The region covers the modules above the lattice point (45, h), 0 … 2, and by number module 4, below.
  d.kinds.regions = {{design::Box{{0, kHeight_mm, -1}, {100, 100, 1}}, 1}, {design::ModulePart{{4}}, 1}};
  design::assign_kinds(d.kinds, d.layout);
  d.design_id = design::design_id_of(d);
  const auto kinds = [](const Design& of) {
    std::vector<int> list;
    for (const auto& m : of.layout.modules) list.push_back(m.kind);
    return list;
  };
  EXPECT_EQ(kinds(d), (std::vector{1, 1, 1, 0, 1}));
  EXPECT_EQ(broken_by(d), Nothing{});
  const Design image = mirror_design(d, {Vec3::UnitY(), 0.0}).design;
  EXPECT_EQ(kinds(image), kinds(d));
  EXPECT_EQ(broken_by(image), Nothing{});
  // Module 1 is removed and added again as the fifth, above the lattice point, with its kind; 4 keeps the kind that it
  // has by number; the missing one below gets the standard kind.
  const EditedDesign e = edit_design(d, {{1}, {TileOfIsland{0, kRing[1]}, TileOfIsland{0, kRing[kMissing]}}});
  EXPECT_EQ(kinds(e.design), (std::vector{1, 1, 0, 1, 1, 0}));
  EXPECT_EQ(e.design.kinds.regions.size(), 1U);
  EXPECT_EQ(broken_by(e.design), Nothing{});
  Design damaged = d;
  damaged.layout.modules[3].kind = 1;
  EXPECT_EQ(broken_by(damaged).size(), 1U);  // The damaged value is its id.
  damaged = d;
  damaged.kinds.kinds[0].taxels = 13;
  damaged.design_id = design::design_id_of(damaged);
  const std::vector<std::string> expected{"kinds: kind \"soft\": 13 taxels; a converter has 1 … 12"};
  EXPECT_EQ(broken_by(damaged), expected);
}

// The cover is the generated forearm.
Design curved(int iterations) {
  mesh::GenerateOptions size;
  const test::CoverFile file("edit_cover", mesh::generate(*mesh::shape_named("forearm"), size));
  DesignOptions options;
  options.iterations = iterations;
  options.time_limit_s = 300.0;
  return make_design(file.path(), options).design;
}

TEST(EditDesign, what_is_kept_stays_and_the_value_never_falls) {
  const Design whole = curved(1);
  const int count = static_cast<int>(whole.layout.modules.size());
  // A band of it is kept, and the removed modules are grown anew.
  std::vector<int> gone;
  for (int id = 0; id < count; ++id) {
    if (id % 3 == 0) gone.push_back(id);
  }
  const Design before = edit_design(whole, {gone, {}}).design;
  std::vector<int> kept(before.layout.modules.size() / 2);
  std::iota(kept.begin(), kept.end(), 0);
  const GrowAroundOptions effort{300.0, 40, 2};
  const EditedDesign e = grow_around(before, kept, effort);
  expect_where_they_stood(before, e);
  EXPECT_GT(e.design.layout.modules.size(), before.layout.modules.size());
  for (const int id : kept) {
    const auto& was = before.layout.modules[static_cast<std::size_t>(id)];
    const auto& is = e.design.layout.modules.at(static_cast<std::size_t>(e.new_id[static_cast<std::size_t>(id)]));
    for (std::size_t s = 0; s < 3; ++s) {
      const int other = was.neighbour[s];
      if (other >= 0 && other < static_cast<int>(kept.size())) {
        EXPECT_EQ(is.neighbour[s], e.new_id[static_cast<std::size_t>(other)]);
      }
    }
  }
  EXPECT_EQ(broken_by(e.design), Nothing{});
  EXPECT_EQ(grow_around(before, kept, effort).design.design_id, e.design.design_id);
  const auto value = [](const Design& d) {
    return static_cast<double>(d.layout.modules.size()) -
           d.price.of(static_cast<int>(d.patches.size()), static_cast<int>(d.layout.jumpers.size()), d.layout.islands);
  };
  EXPECT_GE(value(e.design), value(before));
  // If all are kept and nothing fits beside them, the design stays the same.
  const EditedDesign again = grow_around(e.design,
                                         [&] {
                                           std::vector<int> all(e.design.layout.modules.size());
                                           std::iota(all.begin(), all.end(), 0);
                                           return all;
                                         }(),
                                         {300.0, 1, 1});
  expect_where_they_stood(e.design, again);
  EXPECT_GE(value(again.design), value(e.design) - 1e-9);
  EXPECT_THROW((void)grow_around(before, {count}, effort), InputError);
}

// The covers are designed with small effort; the rules must hold in any case.
class Covers : public testing::TestWithParam<test::CoverName> {};

TEST_P(Covers, keep_every_rule_after_each_change) {
  const auto file = test::cover_file(GetParam());
  if (!file) GTEST_SKIP() << test::no_data();
  DesignOptions options;
  options.iterations = 60;
  options.time_limit_s = 300.0;
  const Design d = make_design(file->path(), options).design;
  ASSERT_GT(d.layout.modules.size(), 8U);

  const EditedDesign fewer = edit_design(d, {{1, 4, 5}, {}});
  expect_where_they_stood(d, fewer);
  EXPECT_EQ(broken_by(fewer.design), Nothing{});
  int tried = 0, added = 0;
  for (std::size_t id = 0; id < fewer.design.layout.modules.size() && tried < 12; ++id) {
    for (int s = 0; s < 3 && tried < 12; ++s) {
      if (fewer.design.layout.modules[id].neighbour[static_cast<std::size_t>(s)] >= 0) continue;
      ++tried;
      EditedDesign more;
      if (!error_of([&] { more = edit_design(fewer.design, {{}, {BesideModule{static_cast<int>(id), s}}}); }).empty())
        continue;
      ++added;
      expect_where_they_stood(fewer.design, more);
      EXPECT_EQ(broken_by(more.design), Nothing{}) << id << "." << s;
    }
  }
  EXPECT_GT(added, 0);

  const EditedDesign grown = grow_around(fewer.design, {0, 1, 2, 3, 5, 6}, {300.0, 30, 2});
  expect_where_they_stood(fewer.design, grown);
  EXPECT_EQ(broken_by(grown.design), Nothing{});

  const EditedDesign image = mirror_design(d, {Vec3(1, 2, -0.5).normalized(), 30.0});
  EXPECT_EQ(broken_by(image.design), Nothing{});
  EXPECT_EQ(image.design.layout.modules.size(), d.layout.modules.size());
  EXPECT_EQ(image.design.patches.size(), d.patches.size());
  EXPECT_EQ(image.design.name, d.name + "_mirrored");
  // Mirroring twice at a coordinate plane gives the same design, to the last digit of each corner.
  const design::MirrorPlane y{Vec3::UnitY(), 0.0};
  const Design twice = mirror_design(mirror_design(d, y).design, y).design;
  EXPECT_EQ(twice.design_id, d.design_id);
  EXPECT_EQ(twice.name, d.name);
  for (std::size_t k = 0; k < d.alternatives.size(); ++k)
    EXPECT_EQ(broken_by(take_alternative(image.design, static_cast<int>(k))), Nothing{}) << k;
}
INSTANTIATE_TEST_SUITE_P(Covers, Covers,
                         testing::Values(test::CoverName{"forearm"}, test::CoverName{"LH_hipwing_v1"},
                                         test::CoverName{"RUF_forearm_v2"}),
                         [](const auto& cover) { return test::case_name(cover.param.name); });

}  // namespace
}  // namespace triskin::pipeline
