// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/side_by_side.hpp"

#include <algorithm>

#include "triskin/base/error.hpp"
#include "triskin/design/module_number.hpp"

namespace triskin::design {
namespace {

// An id of −1 means "none" and is not shifted.
int shifted(int id, int by) {
  return id < 0 ? id : id + by;
}

void shift_pairs(std::vector<std::array<int, 2>>& pairs, int by) {
  for (auto& pair : pairs) {
    for (int& id : pair) id = shifted(id, by);
  }
}

void append_surface(Mesh& all, const Mesh& mesh, const Eigen::Isometry3d& pose) {
  const int first = static_cast<int>(all.vertices.size());
  for (const Vec3& v : mesh.vertices) all.vertices.emplace_back(pose * v);
  for (const auto& f : mesh.faces) all.faces.push_back({f[0] + first, f[1] + first, f[2] + first});
}

PlacedModule moved(PlacedModule m, const CoverOffset& offset, const Eigen::Isometry3d& pose) {
  m.island += offset.island;
  m.kind = 0;  // Each cover numbers its kinds on its own, so the joint design has only the standard kind.
  for (Vec3& corner : m.corner_mm) corner = pose * corner;
  for (int& n : m.neighbour) n = shifted(n, offset.module);
  return m;
}

void renumber(FailureLoss& f, int by) {
  f.node = shifted(f.node, by);
  f.other_node = shifted(f.other_node, by);
  shift_pairs(f.backup_tree, by);
  shift_pairs(f.adopted, by);
}

Patch renumbered(Patch p, int by) {
  p.entry = shifted(p.entry, by);
  p.second_entry = shifted(p.second_entry, by);
  for (RoutedModule& m : p.modules) {
    m.node = shifted(m.node, by);
    m.parent = shifted(m.parent, by);
  }
  shift_pairs(p.cut_joints, by);
  shift_pairs(p.bridges, by);
  for (FailureLoss& f : p.failures) renumber(f, by);
  for (int& node : p.articulation) node = shifted(node, by);
  return p;
}

void append(Design& all, const Design& one, const CoverOffset& offset, const Eigen::Isometry3d& pose) {
  const std::vector<int> numbers = all_numbers(one.layout);
  all.layout.numbers.insert(all.layout.numbers.end(), numbers.begin(), numbers.end());
  append_surface(all.surface, one.surface, pose);
  for (const PlacedModule& m : one.layout.modules) all.layout.modules.push_back(moved(m, offset, pose));
  for (Jumper j : one.layout.jumpers) {
    for (int& node : j.node) node += offset.module;
    all.layout.jumpers.push_back(j);
  }
  all.layout.islands += one.layout.islands;
  for (std::size_t p = 0; p < one.patches.size(); ++p) {
    all.patches.push_back(renumbered(one.patches[p], offset.module));
    all.node_addresses.push_back(static_cast<std::uint8_t>(node_address_of(one, layout::PatchIndex{p})));
  }
  all.report.area_cm2 += one.report.area_cm2;
  all.report.upper_bound += one.report.upper_bound;
  all.report.patches_lower_bound += one.report.patches_lower_bound;
}

void require_corner_cut(const Design& design, double corner_cut_mm) {
  if (design.layout.corner_cut_mm == corner_cut_mm) return;
  throw InputError("cover " + design.name +
                   ": its modules have other corner cuts than those of the first cover; make the designs with one "
                   "--corner-cut-mm");
}

}  // namespace

SideBySide side_by_side(std::span<const PlacedCover> covers) {
  SideBySide joint;
  Design& all = joint.design;
  if (!covers.empty()) {
    all.limits = covers.front().design->limits;
    all.layout.method = covers.front().design->layout.method;
    all.layout.corner_cut_mm = covers.front().design->layout.corner_cut_mm;
  }
  for (const PlacedCover& c : covers) {
    require_corner_cut(*c.design, all.layout.corner_cut_mm);
    const CoverOffset offset{layout::SkinModule{all.layout.modules.size()}, static_cast<int>(all.patches.size()),
                             all.layout.islands};
    append(all, *c.design, offset, c.pose);
    joint.offsets.push_back(offset);
    all.covers.push_back({c.design->name, offset});
    all.name += (all.name.empty() ? "" : " + ") + c.design->name;
  }
  all.design_id = design_id_of(all);
  return joint;
}

}  // namespace triskin::design
