// SPDX-License-Identifier: GPL-3.0-or-later
// Printed labels and soldered straps outlive an edit: random edits of generated covers.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <set>
#include <string>

#include "support/covers.hpp"
#include "triskin/base/dice.hpp"
#include "triskin/base/error.hpp"
#include "triskin/pipeline/edit_design.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::pipeline {
namespace {

using design::Design;

constexpr int kEditsPerCover = 50;

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

struct Tally {
  int edits = 0, kept = 0, moved_down = 0, controllers = 0;
};

void expect_labels_hold(const Design& before, const EditedDesign& e, Tally& tally) {
  const int count = static_cast<int>(e.design.layout.modules.size());
  std::vector<int> old_id(static_cast<std::size_t>(count), -1), itself(before.layout.modules.size());
  for (std::size_t id = 0; id < e.new_id.size(); ++id) {
    itself[id] = static_cast<int>(id);
    if (e.new_id[id] < 0) continue;
    ++tally.kept;
    // A number that is still in range is kept; a design has no gaps, so only the highest ones can move.
    if (static_cast<int>(id) < count) {
      EXPECT_EQ(e.new_id[id], static_cast<int>(id));
    } else {
      ++tally.moved_down;
    }
    old_id[static_cast<std::size_t>(e.new_id[id])] = static_cast<int>(id);
  }
  ASSERT_EQ(e.new_patch.size(), before.patches.size());
  for (std::size_t p = 0; p < before.patches.size(); ++p) {
    const auto stays = [&](const design::RoutedModule& m) { return e.new_id[static_cast<std::size_t>(m.node)] >= 0; };
    if (!std::ranges::all_of(before.patches[p].modules, stays)) continue;
    ++tally.controllers;
    ASSERT_GE(e.new_patch[p], 0) << p;
    if (p < e.design.patches.size()) {
      EXPECT_EQ(e.new_patch[p], static_cast<int>(p));
    }
    EXPECT_EQ(wiring_of_patch(e.design.patches[static_cast<std::size_t>(e.new_patch[p])], old_id),
              wiring_of_patch(before.patches[p], itself))
        << p;
  }
}

class Labels : public testing::TestWithParam<const char*> {};

TEST_P(Labels, hold_through_random_edits) {
  const test::CoverFile file(std::string("labels_") + GetParam(), mesh::generate(*mesh::shape_named(GetParam()), {}));
  DesignOptions options;
  options.iterations = 1;
  options.time_limit_s = 300.0;
  Design d = make_design(file.path(), options);
  Dice dice(60);
  Tally tally;
  while (tally.edits < kEditsPerCover) {
    EditedDesign e;
    try {
      e = edit_design(d, random_edit(d, dice));
    } catch (const InputError&) {
      continue;  // no module fits there
    }
    ++tally.edits;
    expect_labels_hold(d, e, tally);
    if (HasFatalFailure()) return;
    d = std::move(e.design);
  }
  EXPECT_GT(tally.controllers, kEditsPerCover);
  RecordProperty("kept", tally.kept);
  RecordProperty("moved_down", tally.moved_down);
  RecordProperty("controllers", tally.controllers);
  std::printf(
      "%s: %d edits, %d kept modules, %d of them above the last number and renumbered, %d untouched controllers\n",
      GetParam(), tally.edits, tally.kept, tally.moved_down, tally.controllers);
}
INSTANTIATE_TEST_SUITE_P(Shapes, Labels, testing::Values("forearm", "torso", "hip", "thigh"),
                         [](const auto& shape) { return std::string(shape.param); });

}  // namespace
}  // namespace triskin::pipeline
