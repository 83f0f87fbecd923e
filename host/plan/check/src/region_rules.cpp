// SPDX-License-Identifier: GPL-3.0-or-later
// Checks regions: places that must stay free are free, and those that must be covered are covered.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "checked_body.hpp"
#include "surface_index.hpp"

namespace triskin::check {
namespace {

constexpr double kPlaceStep_mm = 0.9;  // Places that must be covered are this far apart.
// Solver and checker test different places, so one may be this much farther off.
constexpr double kPlaceSlack_mm = 1.0;
constexpr double kStatedReach_mm = 0.15;
constexpr double kBodyStep_mm = 0.1;     // A distance along a line costs fifty times that of a point.
constexpr double kMaxParts = 5000.0;     // No cover exceeds 5 m, so a face's side has at most this many parts.
constexpr double kEntrySlack_mm = 0.01;  // The closest points of solver and checker differ by less than this.
constexpr double kSheet_mm = 8.0;        // Points higher over a module belong to another sheet.

double distance_to_edge(const P3& p, const P3& a, const P3& b) {
  const P3 d = b - a;
  const double part = d.squaredNorm() > 0.0 ? std::min(1.0, std::max(0.0, d.dot(p - a) / d.squaredNorm())) : 0.0;
  return (a + part * d - p).norm();
}

// Groups the border edges of the surface by shared corners: each group is one loop, or several that touch.
std::vector<std::vector<std::array<int, 2>>> loops_of(const CheckedDesign& d) {
  std::map<std::pair<int, int>, int> uses;
  for (const auto& f : d.faces) {
    for (std::size_t k = 0; k < 3; ++k) ++uses[std::minmax(f[k], f[(k + 1) % 3])];
  }
  std::map<int, std::vector<int>> beside;
  for (const auto& [edge, count] : uses) {
    if (count != 1) continue;
    beside[edge.first].push_back(edge.second);
    beside[edge.second].push_back(edge.first);
  }
  std::vector<std::vector<std::array<int, 2>>> loops;
  std::set<int> seen;
  for (const auto& [first, ends] : beside) {
    if (!seen.insert(first).second) continue;
    loops.emplace_back();
    std::vector<int> open{first};
    while (!open.empty()) {
      const int v = open.back();
      open.pop_back();
      for (const int w : beside[v]) {
        if (v < w) loops.back().push_back({v, w});
        if (seen.insert(w).second) open.push_back(w);
      }
    }
  }
  return loops;
}

std::vector<std::pair<P3, P3>> border_of(const CheckedDesign& d, const CheckedDesign::Region& r) {
  std::vector<std::pair<P3, P3>> edges;
  const auto vertex = [&](int v) { return d.vertices[static_cast<std::size_t>(v)]; };
  for (const auto& loop : loops_of(d)) {
    double width = 0.0;
    for (const auto& a : loop) {
      for (const auto& b : loop) {
        for (const std::size_t k : {0U, 1U})
          width = std::max({width, (vertex(a[0]) - vertex(b[k])).norm(), (vertex(a[1]) - vertex(b[k])).norm()});
      }
    }
    if (width < r.min_width || width > r.max_width) continue;
    for (const auto& [a, b] : loop) edges.emplace_back(vertex(a), vertex(b));
  }
  return edges;
}

// A region, and which faces of the surface it names.
class RegionArea {
 public:
  RegionArea(const CheckedDesign& d, const CheckedDesign::Region& r) : d_(d), r_(r), named_(d.faces.size(), false) {
    if (r.kind == CheckedDesign::Region::Kind::kObstacle) body_.emplace(r.body_vertices, r.body_faces);
    if (r.kind == CheckedDesign::Region::Kind::kBorder) rim_ = border_of(d, r);
    for (const int f : r.faces) named_[static_cast<std::size_t>(f)] = true;
    if (r.kind != CheckedDesign::Region::Kind::kFaces) return;
    std::map<std::pair<int, int>, std::array<int, 2>> sides;  // The faces at each side are counted, named or not.
    for (std::size_t f = 0; f < d.faces.size(); ++f) {
      for (std::size_t k = 0; k < 3; ++k)
        ++sides[std::minmax(d.faces[f][k], d.faces[f][(k + 1) % 3])][named_[f] ? 0 : 1];
    }
    for (const auto& [edge, count] : sides) {
      if (count[0] > 0 && count[1] > 0)
        rim_.push_back(
            {d.vertices[static_cast<std::size_t>(edge.first)], d.vertices[static_cast<std::size_t>(edge.second)]});
    }
  }

  [[nodiscard]] bool has_body() const { return body_.has_value(); }

  // Distance to the rim, negative outside.
  [[nodiscard]] double depth(const P3& p, std::size_t face) const {
    using Kind = CheckedDesign::Region::Kind;
    if (r_.kind == Kind::kSphere) return r_.radius - (p - r_.a).norm();
    if (r_.kind == Kind::kBox) {
      double least = std::numeric_limits<double>::infinity();
      for (int k = 0; k < 3; ++k) least = std::min({least, p[k] - r_.a[k], r_.b[k] - p[k]});
      return least;
    }
    if (body_) {
      const P3 normal = face_normal(face);
      return r_.margin - body_->least_along(p - r_.below * normal, p + r_.above * normal);
    }
    double least = 1e6;
    for (const auto& [a, b] : rim_) least = std::min(least, distance_to_edge(p, a, b));
    if (r_.kind == Kind::kBorder) return r_.margin - least;
    return named_[face] ? least : -least;
  }

  // Calls `visit(place)` for places of the region that are at most the step apart.
  void each_place(double step, const auto& visit) const {
    for (std::size_t f = 0; f < d_.faces.size(); ++f) {
      const auto corner = [&](std::size_t k) { return d_.vertices[static_cast<std::size_t>(d_.faces[f][k])]; };
      const P3 a = corner(0), u = corner(1) - a, v = corner(2) - a;
      const double longest = std::max({u.norm(), v.norm(), (u - v).norm()});
      if (depth(a + (u + v) / 3.0, f) < -longest) continue;
      const int n = static_cast<int>(std::ceil(std::min(longest / step, kMaxParts)));
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n - i; ++j) {
          const P3 p = a + (i + 1.0 / 3.0) / n * u + (j + 1.0 / 3.0) / n * v;
          if (depth(p, f) >= 0.0) visit(p);
        }
      }
    }
  }

 private:
  [[nodiscard]] P3 face_normal(std::size_t face) const {
    const auto corner = [&](std::size_t k) { return d_.vertices[static_cast<std::size_t>(d_.faces[face][k])]; };
    return (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
  }

  const CheckedDesign& d_;
  const CheckedDesign::Region& r_;
  std::optional<CheckedBody> body_;
  std::vector<bool> named_;
  std::vector<std::pair<P3, P3>> rim_;
};

// Returns how far the projection of a module's points on the surface reaches into the region, by parts as for the
// overrun.
double reach_into(const RegionArea& area, const SurfaceIndex& surface, const Outline3& outline) {
  const double step_mm = area.has_body() ? kBodyStep_mm : 0.02;
  constexpr double kPart = 0.05, kSlope = 2.0;  // Depths beyond 1 mm are measured with a tolerance of 5 %.
  double most = 0.0;
  std::vector<std::array<P3, 3>> parts;
  for (std::size_t k = 2; k < outline.size(); ++k) parts.push_back({outline[0], outline[k - 1], outline[k]});
  while (!parts.empty()) {
    const auto t = parts.back();
    parts.pop_back();
    const P3 middle = centroid(t);
    const double radius = std::max({(t[0] - middle).norm(), (t[1] - middle).norm(), (t[2] - middle).norm()});
    const auto hit = surface.closest(middle);
    const double here = area.depth(hit.point, hit.face);
    most = std::max(most, here);
    const double known = most + step_mm + kPart * std::max(0.0, most - 1.0);
    if (!(here + kSlope * radius > known && std::isfinite(radius))) continue;
    const P3 p = (t[0] + t[1]) / 2, q = (t[1] + t[2]) / 2, r = (t[2] + t[0]) / 2;
    for (const auto& part :
         {std::array{t[0], p, r}, std::array{p, t[1], q}, std::array{r, q, t[2]}, std::array{p, q, r}})
      parts.push_back(part);
  }
  return most;
}

// Returns the distance from a module, seen along its normal; infinite for a place on another sheet.
double distance_from(const Outline3& outline, const P3& place) {
  const P3 n = (outline[1] - outline[0]).cross(outline[2] - outline[0]).normalized();
  const double height = n.dot(place - outline[0]);
  if (!(std::abs(height) <= kSheet_mm)) return std::numeric_limits<double>::infinity();
  const P3 foot = place - height * n;
  double least = std::numeric_limits<double>::infinity();
  bool outside = false;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const P3 &a = outline[k], &b = outline[(k + 1) % outline.size()];
    least = std::min(least, distance_to_edge(foot, a, b));
    outside = outside || n.dot((b - a).cross(foot - a)) < 0;
  }
  return outside ? least : 0.0;
}

void check_free(const CheckedDesign& d, const SurfaceIndex& surface, Findings& f) {
  std::vector<double> reach(d.modules.size(), 0.0);
  for (const auto& region : d.regions) {
    if (!region.free) continue;
    const RegionArea area(d, region);
    for (std::size_t k = 0; k < d.modules.size(); ++k) {
      const double into = reach_into(area, surface, module_outline(d.modules[k].corner, d.corner_cut));
      reach[k] = std::max(reach[k], into);
      if (!(into <= d.limits.overrun)) {
        f.broken("keep-out", d.name(k),
                 fmt::format("reaches {:.3f} mm into region \"{}\", which must stay free, limit {} mm", into,
                             region.name, d.limits.overrun));
      }
    }
  }
  for (std::size_t k = 0; k < reach.size(); ++k) {
    if (!(std::abs(reach[k] - d.modules[k].keep_out) <= kStatedReach_mm + 0.1 * reach[k])) {
      f.broken("keep-out", d.name(k),
               fmt::format("stated {:.3f} mm, measured {:.3f} mm", d.modules[k].keep_out, reach[k]));
    }
  }
}

void check_cover(const CheckedDesign& d, Findings& f) {
  std::vector<Outline3> outlines;
  for (const auto& m : d.modules) outlines.push_back(module_outline(m.corner, d.corner_cut));
  for (const auto& region : d.regions) {
    if (!region.cover) continue;
    double farthest = 0.0;
    P3 where = P3::Zero();
    RegionArea(d, region).each_place(kPlaceStep_mm, [&](const P3& place) {
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < outlines.size() && least > region.within; ++k) {
        if ((d.modules[k].corner[0] - place).norm() < 2.5 * kSide)
          least = std::min(least, distance_from(outlines[k], place));
      }
      if (least <= farthest) return;
      farthest = least;
      where = place;
    });
    if (farthest > region.within + kPlaceSlack_mm) {
      f.broken("must-cover", fmt::format("region {}", region.name),
               fmt::format("({:.1f}, {:.1f}, {:.1f}) lies {:.1f} mm from the nearest module, limit {} mm", where.x(),
                           where.y(), where.z(), farthest, region.within));
    }
  }
}

// The cable of a patch enters at the middle of the side of its entry module where port A lies; a second cable enters at
// the side that the patch names.
class EntryPlaces {
 public:
  EntryPlaces(const CheckedDesign& d, const SurfaceIndex& surface) : d_(d), surface_(surface) {
    for (const auto& region : d.regions) {
      if (region.entry) areas_.emplace_back(d, region);
    }
  }

  [[nodiscard]] bool is_limited() const { return !areas_.empty(); }
  // Returns the distance from the middle of the side to the nearest entry region; 0 or less means inside.
  [[nodiscard]] double outside(int module, int side) const {
    const Triangle3& c = d_.modules[static_cast<std::size_t>(module)].corner;
    const auto s = static_cast<std::size_t>(side);
    const auto hit = surface_.closest(0.5 * (c[s] + c[(s + 1) % 3]));
    double least = std::numeric_limits<double>::infinity();
    for (const RegionArea& area : areas_) least = std::min(least, -area.depth(hit.point, hit.face));
    return least;
  }

 private:
  const CheckedDesign& d_;
  const SurfaceIndex& surface_;
  std::deque<RegionArea> areas_;  // A deque never moves its elements, whose bodies contain pointers to themselves.
};

void check_entries(const CheckedDesign& d, const SurfaceIndex& surface, Findings& f) {
  const EntryPlaces places(d, surface);
  if (!places.is_limited()) return;
  f.rule("entry-place");
  std::vector<int> elsewhere;
  const auto check = [&](std::size_t patch, int module, int side) {
    if (side < 0 || side > 2) return;  // Another rule reports sides out of range.
    const double outside = places.outside(module, side);
    if (!(outside > kEntrySlack_mm)) return;
    if (elsewhere.empty() || elsewhere.back() != static_cast<int>(patch)) elsewhere.push_back(static_cast<int>(patch));
    f.broken(
        "entry-place", fmt::format("patch {}", patch),
        fmt::format("its cable enters module {} {:.1f} mm outside of every entry region", d.number(module), outside));
  };
  for (std::size_t p = 0; p < d.patches.size(); ++p) {
    const auto& patch = d.patches[p];
    if (patch.modules.empty()) continue;
    check(p, patch.entry, d.modules[static_cast<std::size_t>(patch.entry)].rotation);
    if (patch.second_entry >= 0) check(p, patch.second_entry, patch.second_entry_side);
  }
  if (elsewhere != d.entries_elsewhere)
    f.broken("entry-place", "report", "entries_elsewhere does not name the patches whose cable enters elsewhere");
}

}  // namespace

void check_regions(const CheckedDesign& design, Findings& findings) {
  if (design.regions.empty()) return;
  for (const char* rule : {"keep-out", "must-cover"}) findings.rule(rule);
  const SurfaceIndex surface(design);
  check_free(design, surface, findings);
  check_cover(design, findings);
  check_entries(design, surface, findings);
}

}  // namespace triskin::check
