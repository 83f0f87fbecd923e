// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <tuple>

#include "checked_design.hpp"
#include "module_outline.hpp"

namespace triskin::check {
namespace {

constexpr double kRigid_mm = 1e-6;
constexpr double kStated = 1e-6;  // Stated numbers are printed in full, so they must agree to rounding.

// Gives the pads of the iCub triangle relative to the centroid (skinGui), x along side 0 of the turned module, y to the
// far corner.
constexpr double kPad[12][2] = {{6.533, 0},      {9.8, -5.66},  {3.267, -5.66},  {0, 0},
                                {-3.267, -5.66}, {-9.8, -5.66}, {-6.533, -3.75}, {-6.533, 0},
                                {-3.267, 5.66},  {0, 11.317},   {0, 7.507},      {3.267, 5.66}};

void check_rigid(const CheckedDesign& d, Findings& f) {
  f.rule("rigid");
  for (std::size_t k = 0; k < d.modules.size(); ++k) {
    for (std::size_t s = 0; s < 3; ++s) {
      const double side = (d.modules[k].corner[(s + 1) % 3] - d.modules[k].corner[s]).norm();
      if (!(std::abs(side - kSide) <= kRigid_mm))
        f.broken("rigid", d.name(k), fmt::format("side {} is {:.6f} mm, a module's is 30 mm", s, side));
    }
  }
}

void check_tiles(const CheckedDesign& d, Findings& f) {
  f.rule("tile-unique");
  std::map<std::tuple<int, int, int, bool>, std::size_t> seen;
  for (std::size_t k = 0; k < d.modules.size(); ++k) {
    const auto& m = d.modules[k];
    const auto [at, is_new] = seen.try_emplace({m.island, m.i, m.j, m.up}, k);
    if (!is_new) f.broken("tile-unique", d.name(k), "lies on the tile of " + d.name(at->second));
  }
}

void check_joints(const CheckedDesign& d, Findings& f) {
  for (const char* rule : {"joint-symmetric", "joint-lattice", "joint-island"}) f.rule(rule);
  for (std::size_t k = 0; k < d.modules.size(); ++k) {
    for (int s = 0; s < 3; ++s) {
      const int n = d.modules[k].neighbour[static_cast<std::size_t>(s)];
      if (n < 0) continue;
      const auto& other = d.modules[static_cast<std::size_t>(n)];
      const std::string where = fmt::format("{} side {}", d.name(k), s);
      const int t = matching_side(d.modules[k], s, other);
      if (t < 0) {
        f.broken("joint-lattice", where,
                 fmt::format("joined to module {}, whose tile does not share this side", d.number(n)));
      } else if (other.neighbour[static_cast<std::size_t>(t)] != static_cast<int>(k)) {
        f.broken("joint-symmetric", where,
                 fmt::format("module {} is not joined back across its side {}", d.number(n), t));
      }
      if (other.island != d.modules[k].island)
        f.broken("joint-island", where, fmt::format("module {} belongs to another island", d.number(n)));
    }
  }
}

void check_islands(const CheckedDesign& d, Findings& f) {
  f.rule("island-connected");
  std::map<int, int> components;
  std::vector<bool> seen(d.modules.size(), false);
  for (std::size_t first = 0; first < d.modules.size(); ++first) {
    if (seen[first]) continue;
    ++components[d.modules[first].island];
    std::vector<std::size_t> queue{first};
    seen[first] = true;
    for (std::size_t q = 0; q < queue.size(); ++q) {
      for (const int n : d.modules[queue[q]].neighbour) {
        if (n < 0 || seen[static_cast<std::size_t>(n)]) continue;
        seen[static_cast<std::size_t>(n)] = true;
        queue.push_back(static_cast<std::size_t>(n));
      }
    }
  }
  for (const auto& [island, count] : components) {
    if (island < 0 || island >= d.islands)
      f.broken("island-connected", fmt::format("island {}", island), "its number is outside the stated islands");
    if (count != 1)
      f.broken("island-connected", fmt::format("island {}", island), fmt::format("falls apart into {} parts", count));
  }
  if (static_cast<int>(components.size()) != d.islands) {
    f.broken("island-connected", "design", fmt::format("states {} islands, has {}", d.islands, components.size()));
  }
}

void check_hinges(const CheckedDesign& d, Findings& f) {
  for (const char* rule : {"hinge-gap", "fold", "edge-error"}) f.rule(rule);
  for (std::size_t k = 0; k < d.modules.size(); ++k) {
    const auto& m = d.modules[k];
    double edge_error = 0.0;
    for (std::size_t s = 0; s < 3; ++s) {
      double gap = 0.0, fold = 0.0, fold_limit = d.limits.fold;
      if (m.neighbour[s] >= 0) {
        const auto& o = d.modules[static_cast<std::size_t>(m.neighbour[s])];
        const int t = matching_side(m, static_cast<int>(s), o);
        if (t < 0) continue;  // The rule joint-lattice already reports this.
        const P3 &a = m.corner[s], &b = m.corner[(s + 1) % 3], &c = o.corner[static_cast<std::size_t>((t + 1) % 3)],
                 &e = o.corner[static_cast<std::size_t>(t)];
        gap = std::max((a - c).norm(), (b - e).norm());
        fold = std::acos(std::clamp(unit_normal(m.corner).dot(unit_normal(o.corner)), -1.0, 1.0));
        // Over a ridge the neighbour's normal leans outward across the joint, in a valley inward.
        const P3 outward = (a + b) / 2 - centroid(m.corner);
        const bool is_ridge = unit_normal(o.corner).dot(outward) > 0.0;
        fold_limit = std::min(fold_limit, is_ridge ? d.limits.fold_away : d.limits.fold_towards);
        edge_error = std::max(edge_error, std::abs(((b + e) / 2 - (a + c) / 2).norm() - kSide));
      }
      const std::string where = fmt::format("{} side {}", d.name(k), s);
      if (!(gap <= d.limits.hinge_gap))
        f.broken("hinge-gap", where, fmt::format("{:.3f} mm, limit {} mm", gap, d.limits.hinge_gap));
      if (!(fold <= fold_limit)) f.broken("fold", where, fmt::format("{:.3f} rad, limit {:.3f} rad", fold, fold_limit));
      if (!(std::abs(gap - m.hinge_gap[s]) <= kStated))
        f.broken("hinge-gap", where, fmt::format("stated {:.6f} mm, measured {:.6f} mm", m.hinge_gap[s], gap));
      if (!(std::abs(fold - m.fold[s]) <= 1e-5))
        f.broken("fold", where, fmt::format("stated {:.6f} rad, measured {:.6f} rad", m.fold[s], fold));
    }
    if (!(edge_error <= d.limits.edge_error))
      f.broken("edge-error", d.name(k), fmt::format("{:.3f} mm, limit {} mm", edge_error, d.limits.edge_error));
    if (!(std::abs(edge_error - m.edge_error) <= kStated)) {
      f.broken("edge-error", d.name(k), fmt::format("stated {:.6f} mm, measured {:.6f} mm", m.edge_error, edge_error));
    }
  }
}

void check_taxels(const CheckedDesign& d, Findings& f) {
  f.rule("taxel-pose");
  for (std::size_t k = 0; k < d.modules.size(); ++k) {
    const auto& m = d.modules[k];
    if (m.rotation < 0 || m.rotation > 2) continue;  // The rule rotation already reports this.
    const auto r = static_cast<std::size_t>(m.rotation);
    const P3 c = centroid(m.corner), n = unit_normal(m.corner);
    const P3 x = (m.corner[(r + 1) % 3] - m.corner[r]) / kSide, y = n.cross(x);
    for (std::size_t t = 0; t < 12; ++t) {
      const P3 expected = c + kPad[t][0] * x + kPad[t][1] * y;
      if (!((m.taxel[t] - expected).norm() <= 1e-4) || !((m.taxel_normal[t] - n).norm() <= 1e-4)) {
        f.broken("taxel-pose", d.name(k),
                 fmt::format("taxel {} is {:.4f} mm from its place", t, (m.taxel[t] - expected).norm()));
      }
    }
  }
}

// Checks that no taxel was cut off with the corners.
void check_taxels_left(const CheckedDesign& d, Findings& f) {
  if (!(d.corner_cut > 0.0)) return;
  f.rule("taxel-cut");
  for (std::size_t k = 0; k < d.modules.size(); ++k) {
    const auto& m = d.modules[k];
    for (std::size_t t = 0; t < 12; ++t) {
      const double beyond = beyond_cut(m.corner, d.corner_cut, m.taxel[t]);
      if (!(beyond < 0.0))
        f.broken("taxel-cut", d.name(k), fmt::format("taxel {} lies {:.3f} mm in a corner that is cut off", t, beyond));
    }
  }
}

}  // namespace

std::array<int, 2> corner_vertex(const CheckedDesign::Module& m, int corner) {
  static constexpr int kUp[3][2] = {{0, 0}, {1, 0}, {0, 1}}, kDown[3][2] = {{1, 0}, {1, 1}, {0, 1}};
  const auto& c = m.up ? kUp[corner] : kDown[corner];
  return {m.i + c[0], m.j + c[1]};
}

int matching_side(const CheckedDesign::Module& m, int side, const CheckedDesign::Module& other) {
  if (m.up == other.up) return -1;
  for (int t = 0; t < 3; ++t) {
    if (corner_vertex(m, side) == corner_vertex(other, (t + 1) % 3) &&
        corner_vertex(m, (side + 1) % 3) == corner_vertex(other, t))
      return t;
  }
  return -1;
}

void check_modules(const CheckedDesign& design, Findings& findings) {
  check_rigid(design, findings);
  check_tiles(design, findings);
  check_joints(design, findings);
  check_islands(design, findings);
  check_hinges(design, findings);
  check_taxels(design, findings);
  check_taxels_left(design, findings);
}

}  // namespace triskin::check
