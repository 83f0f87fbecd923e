// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>

#include "surface_index.hpp"

namespace triskin::check {
namespace {

constexpr double kStated_mm = 0.01;  // Among closest points that tie, another may be chosen.
constexpr double kBehind_mm = 0.5;   // Overlapping modules may have a side this far behind the other.
constexpr double kLayer_mm = 10.0;   // A jumper does not cross a module that lies farther off along the normal.
constexpr int kSteps = 32;  // docs/design_file.md defines the number of points at which the length is measured.

struct Cable {
  P3 a, b;          // The cable leads between these middles of sides.
  P3 out_a, out_b;  // Both are unit vectors that point away from the centroids.
  P3 normal_a, normal_b;
};

// Returns the length, inside a module and seen from above it, of the part of the segment that is at least `depth` from
// its sides.
double length_inside(const P3& a, const P3& b, const Triangle3& t, double depth) {
  const P3 n = unit_normal(t), between = b - a;
  if (std::abs((a + 0.5 * between - t[0]).dot(n)) > kLayer_mm) return 0.0;
  double low = 0.0, high = 1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const P3 in = n.cross(t[(k + 1) % 3] - t[k]).normalized();
    const double start = in.dot(a - t[k]) - depth, slope = in.dot(between);
    if (slope == 0.0) {
      if (start <= 0.0) return 0.0;
    } else if (slope > 0.0) {
      low = std::max(low, -start / slope);
    } else {
      high = std::min(high, -start / slope);
    }
  }
  return std::max(0.0, high - low) * between.norm();
}

// Returns true if two segments cross, seen along the mean of the normals: each has its ends on both sides of the other.
bool crossing(const Cable& p, const Cable& q) {
  const P3 n = (p.normal_a + p.normal_b + q.normal_a + q.normal_b).normalized();
  if (!n.allFinite() || std::abs(n.dot(p.a + p.b - q.a - q.b)) / 2 > kLayer_mm) return false;
  const P3 x = n.unitOrthogonal(), y = n.cross(x);
  const auto flat = [&](const P3& v) { return P2(v.dot(x), v.dot(y)); };
  const P2 a = flat(p.a), b = flat(p.b), c = flat(q.a), d = flat(q.b);
  const auto area = [](const P2& u, const P2& v, const P2& w) {
    return (v.x() - u.x()) * (w.y() - u.y()) - (v.y() - u.y()) * (w.x() - u.x());
  };
  return (area(a, b, c) > 0) != (area(a, b, d) > 0) && (area(c, d, a) > 0) != (area(c, d, b) > 0);
}

class JumperRules {
 public:
  JumperRules(const CheckedDesign& d, Findings& f) : d_(d), f_(f), surface_(d) {}

  void run() {
    for (std::size_t k = 0; k < d_.jumpers.size(); ++k) {
      ends(d_.jumpers[k], k);
      if (!apart(d_.jumpers[k])) continue;
      cables_.emplace_back(k, cable(d_.jumpers[k]));
      course(d_.jumpers[k], k, cables_.back().second);
    }
    for (std::size_t p = 0; p < cables_.size(); ++p) {
      for (std::size_t q = p + 1; q < cables_.size(); ++q) {
        if (crossing(cables_[p].second, cables_[q].second))
          broken("jumper-crossing", cables_[p].first, fmt::format("crosses {}", name(cables_[q].first)));
      }
    }
  }

 private:
  [[nodiscard]] const CheckedDesign::Module& module(int k) const { return d_.modules[static_cast<std::size_t>(k)]; }
  [[nodiscard]] std::string name(std::size_t k) const {
    return fmt::format("jumper {}–{}", d_.number(d_.jumpers[k].module[0]), d_.number(d_.jumpers[k].module[1]));
  }
  void broken(const char* rule, std::size_t jumper, std::string text) {
    f_.broken(rule, name(jumper), std::move(text));
  }
  [[nodiscard]] static bool apart(const CheckedDesign::Jumper& j) { return j.module[0] != j.module[1]; }

  // Covers kinds, free sides, islands and patches.
  void ends(const CheckedDesign::Jumper& j, std::size_t k) {
    if (j.kind != "cable") broken("jumper-kind", k, fmt::format("is of kind \"{}\", cable is possible", j.kind));
    if (!pairs_.insert(std::minmax(j.module[0], j.module[1])).second)
      broken("jumper-side", k, "joins two modules that another jumper joins");
    for (std::size_t e = 0; e < 2; ++e) {
      const auto& m = module(j.module[e]);
      const int joint = m.neighbour[static_cast<std::size_t>(j.side[e])];
      const std::string place = fmt::format("module {} side {}", d_.number(j.module[e]), j.side[e]);
      if (joint >= 0) broken("jumper-side", k, fmt::format("{} is joined to module {}", place, d_.number(joint)));
      if (!sides_.insert({j.module[e], j.side[e]}).second)
        broken("jumper-side", k, fmt::format("{} has another jumper", place));
      if (m.parent < 0 && m.rotation == j.side[e])
        broken("jumper-side", k, fmt::format("{} is where the cable of patch {} enters", place, m.patch));
      for (const auto& p : d_.patches) {
        if (p.second_entry == j.module[e] && p.second_entry_side == j.side[e])
          broken("jumper-side", k, fmt::format("{} is where the second cable of patch {} enters", place, m.patch));
      }
    }
    const auto &a = module(j.module[0]), &b = module(j.module[1]);
    if (a.island == b.island) broken("jumper-island", k, fmt::format("joins island {} to itself", a.island));
    if (a.patch != b.patch) broken("jumper-use", k, fmt::format("joins patches {} and {}", a.patch, b.patch));
  }

  [[nodiscard]] Cable cable(const CheckedDesign::Jumper& j) const {
    std::array<P3, 2> middle, out, normal;
    for (std::size_t e = 0; e < 2; ++e) {
      const Triangle3& t = module(j.module[e]).corner;
      const auto s = static_cast<std::size_t>(j.side[e]);
      middle[e] = (t[s] + t[(s + 1) % 3]) / 2.0;
      normal[e] = unit_normal(t);
      out[e] = (t[(s + 1) % 3] - t[s]).cross(normal[e]).normalized();
    }
    return {middle[0], middle[1], out[0], out[1], normal[0], normal[1]};
  }

  // Covers direction, length, fold and the modules under the cable.
  void course(const CheckedDesign::Jumper& j, std::size_t k, const Cable& c) {
    const double turned = std::acos(std::clamp(c.out_a.dot(c.out_b), -1.0, 1.0));
    const double ahead = std::min((c.b - c.a).dot(c.out_a), (c.a - c.b).dot(c.out_b));
    if (!(turned >= 2.0 * M_PI / 3.0 - 1e-6))
      broken("jumper-facing", k,
             fmt::format("its sides look {:.0f}° apart, at least 120° face each other", turned * 180.0 / M_PI));
    else if (!(ahead >= -kBehind_mm - 1e-6))
      broken("jumper-facing", k, fmt::format("one of its sides lies {:.2f} mm behind the other", -ahead));
    const double length = length_of(c), fold = std::acos(std::clamp(c.normal_a.dot(c.normal_b), -1.0, 1.0));
    if (!(length <= d_.limits.jumper + kStated_mm))
      broken("jumper-length", k, fmt::format("{:.3f} mm, limit {} mm", length, d_.limits.jumper));
    if (!(std::abs(length - j.length) <= kStated_mm))
      broken("jumper-length", k, fmt::format("stated {:.3f} mm, measured {:.3f} mm", j.length, length));
    if (!(fold <= d_.limits.fold + 1e-6))
      broken("jumper-fold", k, fmt::format("{:.3f} rad, limit {:.3f} rad", fold, d_.limits.fold));
    if (!(std::abs(fold - j.fold) <= 1e-5))
      broken("jumper-fold", k, fmt::format("stated {:.6f} rad, measured {:.6f} rad", j.fold, fold));
    for (std::size_t m = 0; m < d_.modules.size(); ++m) {
      if ((centroid(d_.modules[m].corner) - (c.a + c.b) / 2).norm() > kSide + (c.b - c.a).norm()) continue;
      const double inside = length_inside(c.a, c.b, d_.modules[m].corner, d_.limits.penetration + kStated_mm);
      if (inside > 0.0) broken("jumper-crossing", k, fmt::format("lies {:.2f} mm over {}", inside, d_.name(m)));
    }
  }

  // Measures along the surface, at the heights of its ends above it.
  [[nodiscard]] double length_of(const Cable& c) const {
    const P3 off_a = c.a - surface_.closest(c.a).point, off_b = c.b - surface_.closest(c.b).point;
    double length = 0.0;
    P3 last = c.a;
    for (int step = 1; step <= kSteps; ++step) {
      const double t = step / static_cast<double>(kSteps);
      const P3 point = surface_.closest(c.a + (c.b - c.a) * t).point + off_a * (1 - t) + off_b * t;
      length += (point - last).norm();
      last = point;
    }
    return length;
  }

  const CheckedDesign& d_;
  Findings& f_;
  SurfaceIndex surface_;
  std::set<std::pair<int, int>> sides_, pairs_;
  std::vector<std::pair<std::size_t, Cable>> cables_;
};

}  // namespace

void check_jumpers(const CheckedDesign& design, Findings& findings) {
  if (design.jumpers.empty()) return;
  for (const char* rule : {"jumper-kind", "jumper-side", "jumper-island", "jumper-use", "jumper-facing",
                           "jumper-length", "jumper-fold", "jumper-crossing", "jumpers-bound"}) {
    findings.rule(rule);
  }
  JumperRules(design, findings).run();
  if (static_cast<int>(design.jumpers.size()) < design.jumpers_lower_bound) {
    findings.broken(
        "jumpers-bound", "design",
        fmt::format("{} jumpers under the stated lower bound {}", design.jumpers.size(), design.jumpers_lower_bound));
  }
}

}  // namespace triskin::check
