// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "checked_design.hpp"

namespace triskin::check {
namespace {

using RayKernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<RayKernel::Triangle_3>;
using RayPrimitive = CGAL::AABB_triangle_primitive<RayKernel, Triangles::const_iterator>;
using RayTree = CGAL::AABB_tree<CGAL::AABB_traits<RayKernel, RayPrimitive>>;

constexpr double kMinWall_mm = 0.3, kMaxWall_mm = 8.0;  // docs/mesh.md defines a wall by these limits.
constexpr double kOpposite = -0.7;  // The two sides of a wall have normals with at most this cosine.
// Rays start this far off, because otherwise the side on which they start would stop them.
constexpr double kOff_mm = 0.02;
constexpr int kRays = 96;
// Two means of seven views of 96 rays each differ by chance by 0.03; both sides of a lid by less than 0.1.
constexpr double kSeesMore = 0.1;
constexpr double kRecessShare = 0.1;  // At most this share of the modules on a piece of surface lies in recesses.
constexpr int kMinPlaces = 3;         // This many of the seven places must have a wall behind them.
constexpr double kReach_mm = 40.0;    // If two modules overlap, even across a wall, their middles are nearer than this.
constexpr int kMinBehind = 2;         // This many of ten places of a module must lie over the other one.

RayKernel::Point_3 point(const P3& p) {
  return {p.x(), p.y(), p.z()};
}
P3 vector(const RayKernel::Point_3& p) {
  return {p.x(), p.y(), p.z()};
}

struct Place {
  P3 point, normal;
  std::size_t face = 0;
};

/// Represents the whole part, or the surface that is covered.
class Part {
 public:
  Part(const std::vector<P3>& vertices, const std::vector<std::array<int, 3>>& faces) {
    for (const auto& f : faces) {
      const auto corner = [&](std::size_t k) { return point(vertices[static_cast<std::size_t>(f[k])]); };
      triangles_.emplace_back(corner(0), corner(1), corner(2));
    }
    tree_.insert(triangles_.cbegin(), triangles_.cend());
    tree_.build();
    tree_.accelerate_distance_queries();
  }

  [[nodiscard]] std::optional<Place> below(const P3& p) const {
    const auto [q, primitive] = tree_.closest_point_and_primitive(point(p));
    return place(vector(q), primitive);
  }

  // Returns the other side of the wall under a place.
  [[nodiscard]] std::optional<Place> across(const Place& here) const {
    const P3 from = here.point - kOff_mm * here.normal;
    const RayKernel::Segment_3 inward(point(from), point(here.point - kMaxWall_mm * here.normal));
    std::vector<RayTree::Intersection_and_primitive_id<RayKernel::Segment_3>::Type> hits;
    tree_.all_intersections(inward, std::back_inserter(hits));
    std::optional<Place> nearest;
    for (const auto& [where, primitive] : hits) {
      const auto* q = boost::get<RayKernel::Point_3>(&where);
      if (q == nullptr) continue;
      const auto found = place(vector(*q), primitive);
      if (!found || (nearest && (found->point - from).norm() >= (nearest->point - from).norm())) continue;
      nearest = found;
    }
    if (!nearest || (nearest->point - here.point).norm() < kMinWall_mm) return {};
    return nearest->normal.dot(here.normal) < kOpposite ? nearest : std::nullopt;
  }

  // Returns the fraction of the directions over a place in which nothing of the part lies, weighted by their height.
  [[nodiscard]] double openness(const Place& here) const {
    const P3 x = here.normal.unitOrthogonal(), y = here.normal.cross(x);
    const P3 from = here.point + kOff_mm * here.normal;
    int open = 0;
    for (int k = 0; k < kRays; ++k) {  // In a Hammersley set the height is the root of an even number.
      double mirrored = 0.0, digit = 0.5;
      for (int bits = k; bits > 0; bits /= 2, digit /= 2) mirrored += bits % 2 * digit;
      const double height = std::sqrt((k + 0.5) / kRays), angle = 2.0 * M_PI * mirrored;
      const double across = std::sqrt(1.0 - height * height);
      const P3 ray = across * (std::cos(angle) * x + std::sin(angle) * y) + height * here.normal;
      open += tree_.do_intersect(RayKernel::Ray_3(point(from), point(P3(from + ray)))) ? 0 : 1;
    }
    return static_cast<double>(open) / kRays;
  }

 private:
  [[nodiscard]] std::optional<Place> place(const P3& p, Triangles::const_iterator triangle) const {
    const P3 a = vector(triangle->vertex(0));
    const P3 normal = (vector(triangle->vertex(1)) - a).cross(vector(triangle->vertex(2)) - a);
    if (!(normal.norm() > 0.0)) return {};
    return Place{p, normal.normalized(), static_cast<std::size_t>(triangle - triangles_.cbegin())};
  }

  Triangles triangles_;
  RayTree tree_;
};

// Returns the middle, and the points half-way to corners and sides.
std::vector<P3> places_of(const Triangle3& t) {
  const P3 c = centroid(t);
  std::vector<P3> places{c};
  for (std::size_t k = 0; k < 3; ++k) {
    places.push_back(0.5 * (c + t[k]));
    places.push_back(0.5 * (c + 0.5 * (t[k] + t[(k + 1) % 3])));
  }
  return places;
}

// Both sides of the wall under a module.
struct Views {
  double here = 0.0, there = 0.0;  // The mean fractions of the half spheres that are seen.
  bool is_walled = false;
  [[nodiscard]] bool looks_inner() const { return is_walled && there - here > kSeesMore; }
  [[nodiscard]] bool looks_outer() const { return is_walled && here - there > kSeesMore; }
};

Views views_of(const Triangle3& corners, const Part& part) {
  Views views;
  int walled = 0;
  for (const P3& p : places_of(corners)) {
    const auto place = part.below(p);
    if (!place || place->normal.dot(unit_normal(corners)) < 0.5) continue;
    const auto other = part.across(*place);
    if (!other) continue;
    ++walled;
    views.here += part.openness(*place);
    views.there += part.openness(*other);
  }
  views.is_walled = walled >= kMinPlaces;
  if (walled > 0) {
    views.here /= walled;
    views.there /= walled;
  }
  return views;
}

// Returns for each vertex of the covered surface the lowest vertex of its component.
std::vector<int> components_of(const CheckedDesign& d) {
  std::vector<int> lowest(d.vertices.size());
  std::iota(lowest.begin(), lowest.end(), 0);
  const auto root = [&](int v) {
    while (lowest[static_cast<std::size_t>(v)] != v) {
      const auto at = static_cast<std::size_t>(v);
      lowest[at] = lowest[static_cast<std::size_t>(lowest[at])];
      v = lowest[at];
    }
    return v;
  };
  for (const auto& f : d.faces) {
    for (std::size_t k = 1; k < 3; ++k) {
      const int a = root(static_cast<int>(f[0])), b = root(static_cast<int>(f[k]));
      lowest[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  }
  for (std::size_t v = 0; v < lowest.size(); ++v) lowest[v] = root(static_cast<int>(v));
  return lowest;
}

// Returns the component of the covered surface that lies under a module; −1 if it looks another way at all of its
// places.
int component_under(const Triangle3& corners, const CheckedDesign& d, const Part& surface,
                    const std::vector<int>& component) {
  for (const P3& p : places_of(corners)) {
    const auto place = surface.below(p);
    if (place && place->normal.dot(unit_normal(corners)) > 0.5)
      return component[static_cast<std::size_t>(d.faces[place->face][0])];
  }
  return -1;
}

// The floor of a recess sees less than its back although it is outside. It is known by what the rest of the same piece
// of surface sees: most modules there see more than the other side, and few see less.
bool is_in_recess(int component, const std::vector<int>& under, const std::vector<Views>& views) {
  if (component < 0) return false;
  std::size_t inner = 0, outer = 0, all = 0;
  for (std::size_t k = 0; k < under.size(); ++k) {
    if (under[k] != component) continue;
    ++all;
    inner += views[k].looks_inner() ? 1 : 0;
    outer += views[k].looks_outer() ? 1 : 0;
  }
  return kRecessShare * static_cast<double>(all) >= static_cast<double>(inner) && 2 * outer > all;
}

void check_inner(const CheckedDesign& d, const Part& part, Findings& f) {
  f.rule("inner-side");
  std::vector<Views> views;
  for (const auto& m : d.modules) views.push_back(views_of(m.corner, part));
  const auto inner = static_cast<double>(std::ranges::count_if(views, &Views::looks_inner));
  if (inner == 0.0) return;
  std::vector<int> under(views.size(), -1);
  if (inner <= kRecessShare * static_cast<double>(views.size())) {
    const std::vector<int> component = components_of(d);
    const Part surface(d.vertices, d.faces);
    for (std::size_t k = 0; k < views.size(); ++k)
      under[k] = component_under(d.modules[k].corner, d, surface, component);
  }
  for (std::size_t k = 0; k < views.size(); ++k) {
    if (!views[k].looks_inner() || is_in_recess(under[k], under, views)) continue;
    f.broken("inner-side", d.name(k),
             fmt::format("sees {:.0f} % of its half sphere, the other side of the same wall {:.0f} %",
                         100.0 * views[k].here, 100.0 * views[k].there));
  }
}

bool lies_over(const P3& p, const Triangle3& t) {
  const P3 normal = unit_normal(t);
  for (std::size_t s = 0; s < 3; ++s) {
    if (normal.dot((t[(s + 1) % 3] - t[s]).cross(p - t[s])) < 0.0) return false;
  }
  return true;
}

// Returns true if each is behind the other, with at most a wall between the surfaces on which they lie.
bool back_to_back(const Triangle3& a, const Triangle3& b, const Part& part) {
  const P3 na = unit_normal(a), nb = unit_normal(b), between = centroid(b) - centroid(a);
  if (between.norm() > kReach_mm || na.dot(nb) > -0.5 || between.dot(na) >= 0.0 || between.dot(nb) <= 0.0) return false;
  int behind = 0;
  for (const P3& p : places_of(a)) behind += lies_over(p, b) ? 1 : 0;
  for (const P3& p : b) behind += lies_over(p, a) ? 1 : 0;
  if (behind < kMinBehind) return false;
  const auto under_a = part.below(centroid(a)), under_b = part.below(centroid(b));
  return under_a && under_b && std::abs((under_a->point - under_b->point).dot(na)) <= kMaxWall_mm;
}

void check_backs(const CheckedDesign& d, const Part& part, Findings& f) {
  f.rule("back-to-back");
  for (std::size_t a = 0; a < d.modules.size(); ++a) {
    for (std::size_t b = a + 1; b < d.modules.size(); ++b) {
      if (back_to_back(d.modules[a].corner, d.modules[b].corner, part))
        f.broken("back-to-back", d.name(a), fmt::format("lies back to back with {}", d.name(b)));
    }
  }
}

// A surface with a border may be folded onto itself; its modules then lie back to back without a wall between them.
bool is_closed(const CheckedDesign& d) {
  std::set<std::pair<int, int>> open;
  for (const auto& face : d.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = static_cast<int>(face[k]), b = static_cast<int>(face[(k + 1) % 3]);
      if (open.erase({b, a}) == 0) open.insert({a, b});
    }
  }
  return open.empty();
}

}  // namespace

void check_side(const CheckedDesign& d, Findings& f) {
  if (d.side == "both") return;  // The user asked for both sides.
  if (d.side.empty() && !is_closed(d)) return;
  const bool has_part = !d.part_faces.empty();
  const Part part(has_part ? d.part_vertices : d.vertices, has_part ? d.part_faces : d.faces);
  if (d.side.empty() || (d.side == "outer" && d.is_side_certain)) check_inner(d, part, f);
  check_backs(d, part, f);
}

}  // namespace triskin::check
