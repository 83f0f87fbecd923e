// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/view/comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "triskin/design/side_by_side.hpp"

namespace triskin::view {
namespace {

using Kind = ModuleChange::Kind;

// Design files round to 1 µm; a module that was moved on purpose moves by more than this.
constexpr double kSamePlace_mm = 0.05;

design::Vec3 centre_of(const design::PlacedModule& m) {
  return (m.corner_mm[0] + m.corner_mm[1] + m.corner_mm[2]) / 3.0;
}

bool is_same_place(const design::PlacedModule& a, const design::PlacedModule& b) {
  return std::ranges::all_of(a.corner_mm, [&](const design::Vec3& corner) {
    return std::ranges::any_of(b.corner_mm,
                               [&](const design::Vec3& other) { return (corner - other).norm() <= kSamePlace_mm; });
  });
}

// Sorts the modules of a design by the x of their centres.
std::multimap<double, int> by_x(const design::Design& d) {
  std::multimap<double, int> found;
  for (std::size_t k = 0; k < d.layout.modules.size(); ++k)
    found.emplace(centre_of(d.layout.modules[k]).x(), static_cast<int>(k));
  return found;
}

int same_module(const design::PlacedModule& m, const design::Design& d, const std::multimap<double, int>& modules) {
  const double x = centre_of(m).x();
  const auto end = modules.upper_bound(x + kSamePlace_mm);
  for (auto at = modules.lower_bound(x - kSamePlace_mm); at != end; ++at) {
    if (is_same_place(m, d.layout.modules[static_cast<std::size_t>(at->second)])) return at->second;
  }
  return -1;
}

Changes changes_of(const design::Design& before, const design::Design& after) {
  const int first = static_cast<int>(before.layout.modules.size());
  Changes changes{{}, first, static_cast<int>(before.surface.vertices.size())};
  changes.modules.assign(before.layout.modules.size(), {Kind::kRemoved, -1});
  changes.modules.resize(before.layout.modules.size() + after.layout.modules.size(), {Kind::kAdded, -1});
  const auto places = by_x(before);
  for (std::size_t k = 0; k < after.layout.modules.size(); ++k) {
    const int old = same_module(after.layout.modules[k], before, places);
    if (old < 0) continue;
    const int now = first + static_cast<int>(k);
    changes.modules[static_cast<std::size_t>(old)] = {Kind::kKept, now};
    changes.modules[static_cast<std::size_t>(now)] = {Kind::kKept, old};
  }
  return changes;
}

CoverNote note_of(const char* name, const design::Design& d, const design::CoverOffset& offset) {
  return {name,
          offset.module,
          offset.patch,
          offset.island,
          static_cast<int>(d.layout.modules.size()),
          d.report.area_cm2,
          d.report.coverage};
}

}  // namespace

Comparison compare(const design::Design& before, const design::Design& after) {
  const std::array<design::PlacedCover, 2> covers{
      {{&before, Eigen::Isometry3d::Identity()}, {&after, Eigen::Isometry3d::Identity()}}};
  design::SideBySide joint = design::side_by_side(covers);
  Notes notes;
  notes.covers = {note_of("before", before, joint.offsets[0]), note_of("after", after, joint.offsets[1])};
  notes.changes = changes_of(before, after);
  return {std::move(joint.design), std::move(notes)};
}

}  // namespace triskin::view
