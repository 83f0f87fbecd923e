// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/sheet/bill.hpp"

#include <cmath>
#include <map>

#include "triskin/design/module_side.hpp"
#include "triskin/sheet/landmarks.hpp"

namespace triskin::sheet {
namespace {

// A length of 10 mm plus a rounding error must not become 20 mm.
int rounded_up_mm(double length_mm, int step_mm) {
  return length_mm < 0.0 ? 0 : step_mm * static_cast<int>(std::ceil(length_mm / step_mm - 1e-9));
}

std::vector<PieceCount> list_of(const std::map<int, int>& counts) {
  std::vector<PieceCount> list;
  for (const auto& [length_mm, count] : counts) list.push_back({length_mm, count});
  return list;
}

void count_sides(const Sides& sides, Bill& bill) {
  for (std::size_t k = 0; k < sides.of.size(); ++k) {
    for (const Side& side : sides.of[k]) {
      // A pair is counted once, from the lower module; an outline has no other.
      if (side.other < static_cast<int>(k)) continue;
      bill.kept_joints += side.kind == SideKind::kKept;
      bill.cut_joints += side.kind == SideKind::kCut;
      bill.apart_joints += side.kind == SideKind::kApart;
      bill.slits += side.kind == SideKind::kSlit;
    }
  }
}

}  // namespace

Bill bill_of(const design::Design& design, const Sides& sides) {
  Bill bill;
  bill.modules = static_cast<int>(design.layout.modules.size());
  bill.modules_by_kind = design::count_kinds(design.kinds, design.layout);
  bill.controllers = static_cast<int>(design::patches_of(design).size());
  std::map<int, int> cables, second_cables, jumpers;
  const auto rim = rim_edges_of(design.surface);
  for (const auto& patch : design.patches) {
    for (const auto& m : patch.modules) {
      ++bill.line_straps.at(static_cast<std::size_t>(m.line));
      ++bill.address_straps.at(static_cast<std::size_t>(m.address));
    }
  }
  for (std::size_t k = 0; k < sides.of.size(); ++k) {
    for (std::size_t s = 0; s < 3; ++s) {
      const Side& side = sides.of[k][s];
      if (!side.cable && !side.second_cable) continue;
      const auto at = design::middle_of_side(design.layout.modules[k], static_cast<int>(s));
      ++(side.cable ? cables : second_cables)[rounded_up_mm(distance_to_mm(rim, at), 10)];
    }
  }
  for (const auto& jumper : design.layout.jumpers) ++jumpers[rounded_up_mm(jumper.length_mm, 1)];
  bill.cables = list_of(cables);
  bill.second_cables = list_of(second_cables);
  bill.jumpers = list_of(jumpers);
  count_sides(sides, bill);
  return bill;
}

}  // namespace triskin::sheet
