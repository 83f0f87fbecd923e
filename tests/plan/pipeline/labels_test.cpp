// SPDX-License-Identifier: GPL-3.0-or-later
// Printed labels and soldered straps outlive a change: random edits of generated covers, and revisions of their part.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "support/covers.hpp"
#include "support/temp_folder.hpp"
#include "triskin/base/dice.hpp"
#include "triskin/base/error.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/pipeline/edit_design.hpp"
#include "triskin/pipeline/make_design.hpp"
#include "triskin/pipeline/revise_design.hpp"
#include "triskin/routing/jumpers.hpp"
#include "triskin/session/patch_table.hpp"

namespace triskin::pipeline {
namespace {

using design::Design;
using design::Vec3;

// Six covers have 210 changes together.
constexpr int kChangesPerCover = 35, kChangesPerRevision = 7;

// What is soldered and flashed for a controller: each module by its id in the older design, with straps and parent.
std::set<std::array<int, 5>> wiring_of_patch(const design::Patch& patch, const std::vector<int>& old_id) {
  const auto old = [&](int node) { return node < 0 ? -1 : old_id[static_cast<std::size_t>(node)]; };
  std::set<std::array<int, 5>> rows;
  for (const design::RoutedModule& m : patch.modules)
    rows.insert({old(m.node), old(m.parent), m.rotation, m.line, m.address});
  return rows;
}

// Up to three modules go, and up to three new ones stand at free sides of modules that stay.
LayoutEdit random_edit(const Design& d, Dice& dice) {
  LayoutEdit edit;
  const int count = static_cast<int>(d.layout.modules.size());
  for (int k = dice.below(4); k > 0; --k) edit.remove.push_back(dice.below(count));
  for (int k = dice.below(4); k > 0; --k) {
    const int module = dice.below(count), side = dice.below(3);
    if (std::ranges::count(edit.remove, module) == 0 &&
        d.layout.modules[static_cast<std::size_t>(module)].neighbour[static_cast<std::size_t>(side)] < 0)
      edit.add.push_back(BesideModule{module, side});
  }
  return edit;
}

// The next version of the part: somewhere the surface rises by up to 8 mm.
Design next_part(const Design& d, Dice& dice) {
  constexpr double kRise_mm = 8.0, kRadius_mm = 45.0;
  Design part;
  part.name = d.name;
  part.surface = d.surface;
  Vec3 middle = Vec3::Zero();
  for (const Vec3& v : d.surface.vertices) middle += v / static_cast<double>(d.surface.vertices.size());
  const Vec3 top =
      d.surface.vertices[static_cast<std::size_t>(dice.below(static_cast<int>(d.surface.vertices.size())))];
  for (Vec3& v : part.surface.vertices) {
    const double part_of_radius = (v - top).norm() / kRadius_mm;
    if (part_of_radius < 1.0) v += kRise_mm * (1.0 - part_of_radius * part_of_radius) * (top - middle).normalized();
  }
  return part;
}

EditedDesign revised(const Design& d, Dice& dice) {
  RevisedDesign now = revise_design(d, next_part(d, dice), {300.0, 1, 1});
  Revision& revision = now.revision;
  return {std::move(now.design), std::move(revision.new_id), std::move(revision.added),
          std::move(revision.kept_patches)};
}

// A new module may have taken a side that a jumper needs, or stand across it; then the controller is wired anew.
bool has_its_jumpers(const Design& before, const design::Patch& patch, const EditedDesign& e) {
  const mesh::Surface surface(e.design.surface);
  for (design::Jumper j : before.layout.jumpers) {
    if (std::ranges::none_of(patch.modules, [&](const auto& m) { return m.node == j.node[0]; })) continue;
    for (int& node : j.node) node = e.new_id[static_cast<std::size_t>(node)];
    if (j.node[0] > j.node[1]) {
      std::swap(j.node[0], j.node[1]);
      std::swap(j.side[0], j.side[1]);
    }
    const auto places = routing::find_jumpers(surface, e.design.layout, e.design.limits, std::array{j});
    if (std::ranges::none_of(places, [&](const auto& p) { return p.node == j.node && p.side == j.side; })) return false;
  }
  return true;
}

struct Tally {
  int changes = 0, kept = 0, gaps = 0, controllers = 0, free_numbers = 0, jumpers = 0, without_jumper = 0;
};

// A module that stays has its number; the others have numbers that no module had before. `used` grows by all of them.
void expect_numbers_hold(const Design& before, const EditedDesign& e, std::set<int>& used, Tally& tally) {
  std::set<int> kept;
  for (std::size_t id = 0; id < e.new_id.size(); ++id) {
    if (e.new_id[id] < 0) continue;
    ++tally.kept;
    const int number = design::number_of(before, static_cast<int>(id)).value;
    EXPECT_EQ(design::number_of(e.design, e.new_id[id]), number);
    kept.insert(number);
  }
  const std::vector<int> now = design::all_numbers(e.design.layout);
  ASSERT_EQ(now.size(), e.design.layout.modules.size());
  EXPECT_TRUE(std::ranges::is_sorted(now, std::less_equal{}));
  for (const int number : now) {
    if (kept.contains(number)) continue;
    EXPECT_TRUE(used.insert(number).second) << number << " had been given before";
  }
  tally.gaps = std::max(tally.gaps, now.back() + 1 - static_cast<int>(now.size()));
}

// The bytes that are flashed, without the id of the design, which covers all of its modules.
std::vector<std::uint8_t> table_of(const Design& d, layout::PatchIndex patch) {
  layout::PatchImage image = session::image_of(d, patch);
  image.design_id = 0;
  return session::bytes_of(image);
}

// The labels at both ends of its jumpers are true.
void expect_jumper_names_hold(const Design& before, const design::Patch& patch, const Design& now, Tally& tally) {
  std::set<std::string> names;
  for (const design::Jumper& j : now.layout.jumpers) names.insert(design::jumper_name(now, j));
  EXPECT_EQ(names.size(), now.layout.jumpers.size());
  for (const design::Jumper& j : before.layout.jumpers) {
    if (std::ranges::none_of(patch.modules, [&](const auto& m) { return m.node == j.node[0]; })) continue;
    ++tally.jumpers;
    EXPECT_TRUE(names.contains(design::jumper_name(before, j))) << design::jumper_name(before, j);
  }
}

void expect_labels_hold(const Design& before, const EditedDesign& e, std::set<int>& used, Tally& tally) {
  expect_numbers_hold(before, e, used, tally);
  const int count = static_cast<int>(e.design.layout.modules.size());
  std::vector<int> old_id(static_cast<std::size_t>(count), -1), itself(before.layout.modules.size());
  for (std::size_t id = 0; id < e.new_id.size(); ++id) {
    itself[id] = static_cast<int>(id);
    if (e.new_id[id] >= 0) old_id[static_cast<std::size_t>(e.new_id[id])] = static_cast<int>(id);
  }
  EXPECT_FALSE(e.design.patches.back().is_gap());
  tally.free_numbers =
      std::max(tally.free_numbers, static_cast<int>(std::ranges::count_if(e.design.patches, &design::Patch::is_gap)));
  for (const layout::PatchIndex patch : design::patches_of(before)) {
    const auto p = static_cast<std::size_t>(patch);
    const auto stays = [&](const design::RoutedModule& m) { return e.new_id[static_cast<std::size_t>(m.node)] >= 0; };
    if (!std::ranges::all_of(before.patches[p].modules, stays)) continue;
    if (!has_its_jumpers(before, before.patches[p], e)) {
      ++tally.without_jumper;
      continue;
    }
    ++tally.controllers;
    EXPECT_TRUE(std::ranges::binary_search(e.kept_patches, patch)) << p;
    ASSERT_TRUE(design::has_patch(e.design, patch)) << p;
    EXPECT_EQ(design::node_address_of(e.design, patch), design::node_address_of(before, patch));
    EXPECT_EQ(wiring_of_patch(e.design.patches[p], old_id), wiring_of_patch(before.patches[p], itself)) << p;
    EXPECT_EQ(table_of(e.design, patch), table_of(before, patch)) << p;
    expect_jumper_names_hold(before, before.patches[p], e.design, tally);
  }
}

class Labels : public testing::TestWithParam<test::CoverName> {};

TEST_P(Labels, hold_through_random_changes) {
  const auto file = test::cover_file(GetParam());
  DesignOptions options;
  options.iterations = 1;
  options.time_limit_s = 300.0;
  Design d = make_design(file->path(), options).design;
  Dice dice(60);
  Tally tally;
  const std::vector<int> first = design::all_numbers(d.layout);
  std::set<int> used(first.begin(), first.end());
  while (tally.changes < kChangesPerCover) {
    EditedDesign e;
    try {
      e = tally.changes % kChangesPerRevision == 0 ? revised(d, dice) : edit_design(d, random_edit(d, dice));
    } catch (const InputError&) {
      continue;  // no module fits there
    }
    ++tally.changes;
    expect_labels_hold(d, e, used, tally);
    if (HasFatalFailure()) return;
    d = std::move(e.design);
  }
  EXPECT_GT(tally.controllers, kChangesPerCover);
  EXPECT_GT(tally.free_numbers, 0);
  const test::TempFolder folder;
  design::write_design(folder / "changed.json", d);
  for (const check::Violation& v : check::check_design(folder / "changed.json").violations)
    ADD_FAILURE() << v.rule << ": " << v.where << ": " << v.text;
  EXPECT_LT(tally.without_jumper, tally.controllers / 10);
  RecordProperty("kept", tally.kept);
  RecordProperty("gaps", tally.gaps);
  RecordProperty("controllers", tally.controllers);
  RecordProperty("free_numbers", tally.free_numbers);
  RecordProperty("jumpers", tally.jumpers);
  std::printf(
      "%d changes, %d kept modules, none renumbered, up to %d gaps; %d untouched controllers, none renumbered, "
      "up to %d free numbers, with %d jumpers; %d controllers lost a jumper to a new module\n",
      tally.changes, tally.kept, tally.gaps, tally.controllers, tally.free_numbers, tally.jumpers,
      tally.without_jumper);
}
INSTANTIATE_TEST_SUITE_P(Shapes, Labels,
                         testing::Values(test::CoverName{"forearm"}, test::CoverName{"torso"}, test::CoverName{"hip"},
                                         test::CoverName{"thigh"}, test::CoverName{"forearm", {.size_mm = 200.0}},
                                         test::CoverName{"torso", {.size_mm = 150.0}}),
                         [](const auto& cover) {
                           const int size_mm = static_cast<int>(cover.param.options.size_mm);
                           return size_mm == 0 ? cover.param.name : fmt::format("{}_{}", cover.param.name, size_mm);
                         });

}  // namespace
}  // namespace triskin::pipeline
