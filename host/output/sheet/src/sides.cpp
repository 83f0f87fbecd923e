// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/sheet/sides.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "module_geometry.hpp"
#include "triskin/design/fold.hpp"
#include "triskin/design/module_side.hpp"

namespace triskin::sheet {
namespace {

using design::PlacedModule;
using design::Vec3;

// Returns the angle at side `s` of `a`, across which `b` is joined; it is negative towards the touch side.
double signed_fold_rad(const PlacedModule& a, int s, const PlacedModule& b) {
  const Vec3 na = design::normal_of(a.corner_mm), nb = design::normal_of(b.corner_mm);
  const Vec3 along = a.corner_mm[index((s + 1) % 3)] - a.corner_mm[index(s)];
  const double angle_rad = std::atan2(na.cross(nb).norm(), na.dot(nb));
  return design::folds_away(na, nb, along) ? angle_rad : -angle_rad;
}

void classify(const design::Design& design, Sides& sides) {
  const auto wiring = design::wiring_of(design);
  std::set<std::array<int, 2>> cut;
  for (const auto& patch : design.patches) {
    for (const auto& [a, b] : patch.cut_joints) cut.insert({std::min(a, b), std::max(a, b)});
  }
  const auto& modules = design.layout.modules;
  std::map<std::pair<int, design::Tile>, int> at;
  for (std::size_t k = 0; k < modules.size(); ++k) at[{modules[k].island, modules[k].tile}] = static_cast<int>(k);
  for (std::size_t k = 0; k < modules.size(); ++k) {
    for (int s = 0; s < 3; ++s) {
      Side& side = sides.of[k][index(s)];
      const int joined = modules[k].neighbour[index(s)], id = static_cast<int>(k);
      if (joined < 0) {
        const auto beside = at.find({modules[k].island, design::across(modules[k].tile, s).tile});
        if (beside != at.end()) side = {.kind = SideKind::kSlit, .other = beside->second};
        continue;
      }
      const bool apart = wiring[k].patch < 0 || wiring[k].patch != wiring.at(index(joined)).patch;
      const bool is_cut = cut.contains({std::min(id, joined), std::max(id, joined)});
      side.kind = apart ? SideKind::kApart : is_cut ? SideKind::kCut : SideKind::kKept;
      side.other = joined;
      side.fold_rad = signed_fold_rad(modules[k], s, modules.at(index(joined)));
    }
  }
}

void plug_in(const design::Design& design, Sides& sides) {
  for (const auto& patch : design.patches) {
    for (const auto& m : patch.modules) {
      if (m.parent < 0) sides.of.at(index(m.node)).at(index(m.rotation)).cable = true;
    }
    if (patch.second_entry >= 0)
      sides.of.at(index(patch.second_entry)).at(index(patch.second_entry_side)).second_cable = true;
  }
  for (std::size_t j = 0; j < design.layout.jumpers.size(); ++j) {
    const auto& jumper = design.layout.jumpers[j];
    for (std::size_t end = 0; end < 2; ++end)
      sides.of.at(index(jumper.node[end])).at(index(jumper.side[end])).jumper = static_cast<int>(j);
  }
}

struct FreeSide {
  int module, side;
  Vec3 middle_mm, outward;
};

std::vector<FreeSide> free_sides(const design::Design& design, const Sides& sides) {
  std::vector<FreeSide> free;
  for (std::size_t k = 0; k < sides.of.size(); ++k) {
    for (int s = 0; s < 3; ++s) {
      const SideKind kind = sides.of[k][index(s)].kind;
      if (kind != SideKind::kOutline && kind != SideKind::kSlit) continue;
      if (sides.of[k][index(s)].jumper >= 0) continue;  // The jumper already defines the opposite side.
      const PlacedModule& m = design.layout.modules[k];
      const Vec3 middle = design::middle_of_side(m, s);
      free.push_back({static_cast<int>(k), s, middle, (middle - center_of(m)).normalized()});
    }
  }
  return free;
}

// Returns the index of the nearest side that faces `from`; the number of sides if there is none.
std::size_t nearest(const std::vector<FreeSide>& free, std::size_t from) {
  std::size_t best = free.size();
  double best_mm = kFarthestMatch_mm;
  for (std::size_t k = 0; k < free.size(); ++k) {
    if (free[k].module == free[from].module || free[k].outward.dot(free[from].outward) > -0.5) continue;
    const double distance_mm = (free[k].middle_mm - free[from].middle_mm).norm();
    if (distance_mm > best_mm || (distance_mm == best_mm && best < free.size())) continue;
    best_mm = distance_mm;
    best = k;
  }
  return best;
}

void match(const design::Design& design, Sides& sides) {
  const auto free = free_sides(design, sides);
  std::vector<std::size_t> to(free.size());
  for (std::size_t k = 0; k < free.size(); ++k) to[k] = nearest(free, k);
  for (std::size_t k = 0; k < free.size(); ++k) {
    const std::size_t other = to[k];
    if (other >= free.size() || other < k || to[other] != k) continue;
    const FreeSide &a = free[k], &b = free[other];
    for (const FreeSide* side : {&a, &b})
      sides.of[index(side->module)][index(side->side)].match = static_cast<int>(sides.matches.size());
    sides.matches.push_back({{a.module, b.module}, {a.side, b.side}, (a.middle_mm - b.middle_mm).norm()});
  }
}

}  // namespace

Sides sides_of(const design::Design& design) {
  Sides sides;
  sides.of.resize(design.layout.modules.size());
  classify(design, sides);
  plug_in(design, sides);
  match(design, sides);
  return sides;
}

}  // namespace triskin::sheet
