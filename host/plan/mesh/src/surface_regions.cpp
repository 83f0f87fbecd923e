// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mesh/surface_regions.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "edge_sides.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/index.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/geometry/segment.hpp"

namespace triskin::mesh {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kFreeRim_mm = 1.5, kFreeRimStep_mm = 0.5, kFreeStep_mm = 3.0;
constexpr double kCoverStep_mm = 1.0, kWorthStep_mm = 3.0;
// A place beside a module may be this far from its corner: within_mm, a side, some height.
constexpr double kBeside_mm = 75.0;
constexpr double kSheet_mm = 8.0;           // Points farther above or below belong to another sheet.
constexpr double kStretch = 1.5;            // The path on the surface may exceed that along the module by this factor.
constexpr double kBodyReachStep_mm = 0.05;  // A distance along a line costs fifty times that of a point.
constexpr double kReachStep_mm = 0.005,
                 kReachPart = 0.05;  // keep_out_mm() is found to this share of what exceeds 1 mm.
constexpr double kMaxHeight_mm = 200.0;
constexpr double kModuleRadius_mm = 2.0 * kHeight_mm / 3.0;

[[noreturn]] void refuse_region(const design::Region& r, const std::string& what) {
  throw InputError(fmt::format("region \"{}\": {}; see docs/regions.md", r.name, what));
}

void require_obstacle(const design::Region& r, const design::Obstacle& o) {
  if (!(o.margin_mm >= 0.0 && o.margin_mm <= 1000.0)) refuse_region(r, "margin_mm must be 0 … 1000");
  for (const double height : {o.above_mm, o.below_mm}) {
    if (!(height >= 0.0 && height <= kMaxHeight_mm)) refuse_region(r, "above_mm and below_mm must be 0 … 200");
  }
  if (o.mesh.faces.empty()) refuse_region(r, "its obstacle has no triangle");
}

void require_strip(const design::Region& r, const design::BorderStrip& strip) {
  if (!(strip.margin_mm > 0.0 && strip.margin_mm <= 1000.0))
    refuse_region(r, "margin_mm must be above 0, at most 1000");
  if (!(strip.min_width_mm <= strip.max_width_mm)) refuse_region(r, "min_width_mm must not exceed max_width_mm");
}

void require_faces(const design::Region& r, const design::FaceSet& set, std::size_t faces) {
  for (const FaceIndex f : set.faces) {
    if (f < 0 || at(f) >= faces) refuse_region(r, fmt::format("face {} is not there; 0 … {} are", f, faces - 1));
  }
}

void require_region(const design::Region& r, std::size_t faces) {
  if (r.name.empty()) refuse_region(r, "needs a name");
  if (r.cover && r.free) refuse_region(r, "cannot be covered and free at once");
  if (!r.cover && !r.free && !r.weight && !r.entry)
    refuse_region(r, "says nothing: needs \"weight\", \"cover\", \"free\" or \"entry\"");
  if (r.weight && !(*r.weight >= 0.0 && *r.weight <= 1000.0)) refuse_region(r, "its weight must be 0 … 1000");
  if (!(r.within_mm >= 0.0 && r.within_mm <= 30.0)) refuse_region(r, "within_mm must be 0 … 30");
  if (const auto* s = std::get_if<design::Sphere>(&r.shape)) {
    if (!(s->radius_mm > 0.0 && s->center_mm.allFinite())) refuse_region(r, "its radius must be above 0");
  } else if (const auto* b = std::get_if<design::Box>(&r.shape)) {
    if (!((b->high_mm - b->low_mm).minCoeff() > 0.0)) refuse_region(r, "low_mm must be below high_mm on every axis");
  } else if (const auto* set = std::get_if<design::FaceSet>(&r.shape)) {
    require_faces(r, *set, faces);
  } else if (const auto* strip = std::get_if<design::BorderStrip>(&r.shape)) {
    require_strip(r, *strip);
  } else {
    require_obstacle(r, std::get<design::Obstacle>(r.shape));
  }
}

}  // namespace

SurfaceRegions::SurfaceRegions(const Surface& surface, design::Regions regions)
    : surface_(surface),
      regions_(std::move(regions)),
      groups_(regions_.list.size()),
      bodies_(regions_.list.size()),
      borders_(regions_.list.size()) {
  if (!(regions_.elsewhere >= 0.0 && regions_.elsewhere <= 1000.0))
    throw InputError("regions: \"elsewhere\" must be 0 … 1000; see docs/regions.md");
  has_weights_ = regions_.elsewhere != 1.0;
  const Mesh& mesh = surface_.mesh();
  std::set<std::string> names;
  for (std::size_t k = 0; k < regions_.list.size(); ++k) {
    const design::Region& r = regions_.list[k];
    require_region(r, mesh.faces.size());
    if (!names.insert(r.name).second) refuse_region(r, "the name is taken");
    has_weights_ = has_weights_ || r.weight.has_value();
    prepare(k);
    bool any = false;
    sample(k, 3.0, 3.0, 0.0, [&](const Vec3&, double) { any = true; });
    // An obstacle with a narrow tip may lie between places 3 mm apart.
    if (!any) sample(k, kFreeRimStep_mm, kFreeRimStep_mm, 0.0, [&](const Vec3&, double) { any = true; });
    if (!any) refuse_region(r, "no part of the surface lies in it: it has the frame of the mesh, in mm");
    if (r.free) {
      sample(k, kFreeRimStep_mm, kFreeStep_mm, kFreeRim_mm,
             [this](const Vec3& p, double) { free_points_.push_back(p); });
    }
  }
}

SurfaceRegions::Group SurfaceRegions::group_of(const design::FaceSet& set) const {
  const Mesh& mesh = surface_.mesh();
  Group group;
  group.holds.assign(mesh.faces.size(), 0);
  for (const FaceIndex f : set.faces) group.holds[at(f)] = 1;
  for (const FaceIndex f : set.faces) {
    for (std::size_t s = 0; s < 3; ++s) {
      const FaceIndex other = surface_.neighbours(f)[s];
      if (other < 0 || group.holds[at(other)]) continue;
      group.rim.push_back({mesh.vertices[at(mesh.faces[at(f)][s])], mesh.vertices[at(mesh.faces[at(f)][(s + 1) % 3])]});
    }
  }
  return group;
}

void SurfaceRegions::prepare(std::size_t region) {
  const design::Region& r = regions_.list[region];
  if (const auto* set = std::get_if<design::FaceSet>(&r.shape)) groups_[region] = group_of(*set);
  if (const auto* o = std::get_if<design::Obstacle>(&r.shape))
    bodies_[region] = std::make_unique<const BodyDistance>(o->mesh);
  if (const auto* strip = std::get_if<design::BorderStrip>(&r.shape)) prepare_border(region, *strip);
}

void SurfaceRegions::prepare_border(std::size_t region, const design::BorderStrip& strip) {
  const Mesh& mesh = surface_.mesh();
  Border& border = borders_[region];
  for (const std::vector<VertexIndex>& loop : surface_.border_loops()) {
    const double width = width_of_loop(mesh, loop);
    if (width < strip.min_width_mm || width > strip.max_width_mm) continue;
    for (std::size_t k = 0; k < loop.size(); ++k)
      border.edges.push_back({mesh.vertices[at(loop[k])], mesh.vertices[at(loop[(k + 1) % loop.size()])]});
  }
  if (border.edges.empty()) refuse_region(regions_.list[region], "the surface has no border of that width");
  std::vector<Bvh::Extent> extents;
  for (const auto& [a, b] : border.edges) extents.push_back({a.cwiseMin(b).array(), a.cwiseMax(b).array()});
  border.tree = Bvh(extents);
}

double SurfaceRegions::near_border_mm(std::size_t region, double margin_mm, const Vec3& p) const {
  double best = kFar;
  borders_[region].tree.nearest(p, best, [&](int edge) {
    const auto& [from, to] = borders_[region].edges[at(edge)];
    const double distance = geometry::distance_to_segment(p, from, to);
    best = std::min(best, distance * distance);
  });
  return margin_mm - std::sqrt(best);
}

double SurfaceRegions::near_body_mm(const design::Obstacle& obstacle, const BodyDistance& body, const Vec3& p,
                                    FaceIndex face) const {
  const Vec3& normal = surface_.face_normal(face);
  return obstacle.margin_mm - body.least_along_mm(p - obstacle.below_mm * normal, normal,
                                                  obstacle.below_mm + obstacle.above_mm,
                                                  obstacle.margin_mm + kStretch * kModuleRadius_mm);
}

bool SurfaceRegions::allows_entry(const Vec3& point_mm) const {
  const SurfacePoint foot = surface_.closest(point_mm);
  bool is_limited = false;
  for (std::size_t k = 0; k < regions_.list.size(); ++k) {
    if (!regions_.list[k].entry) continue;
    is_limited = true;
    if (inside_mm(k, foot.position_mm, foot.face) >= 0.0) return true;
  }
  return !is_limited;
}

// > 0 inside: the distance to the rim, or a lower bound of it; < 0 outside.
double SurfaceRegions::inside_mm(std::size_t region, const Vec3& p, FaceIndex face) const {
  const design::Region& r = regions_.list[region];
  if (const auto* s = std::get_if<design::Sphere>(&r.shape)) return s->radius_mm - (p - s->center_mm).norm();
  if (const auto* b = std::get_if<design::Box>(&r.shape))
    return std::min((p - b->low_mm).minCoeff(), (b->high_mm - p).minCoeff());
  if (const auto* o = std::get_if<design::Obstacle>(&r.shape)) return near_body_mm(*o, *bodies_[region], p, face);
  if (const auto* strip = std::get_if<design::BorderStrip>(&r.shape))
    return near_border_mm(region, strip->margin_mm, p);
  const Group& group = groups_[region];
  double least = 1e6;  // No surface has points this far away.
  for (const auto& [from, to] : group.rim) least = std::min(least, geometry::distance_to_segment(p, from, to));
  return group.holds[at(face)] ? least : -least;
}

// Samples a region by points with the area that each represents: parts of faces, divided until they are smaller than
// the step. A finer step holds nearer than `rim_mm` to the rim.
void SurfaceRegions::sample(std::size_t region, double rim_step_mm, double step_mm, double rim_mm,
                            const std::function<void(const Vec3&, double)>& visit) const {
  const Mesh& mesh = surface_.mesh();
  using Divide = std::function<void(const std::array<Vec3, 3>&, FaceIndex)>;
  const Divide divide = [&](const std::array<Vec3, 3>& t, FaceIndex face) {
    const Vec3 middle = (t[0] + t[1] + t[2]) / 3.0;
    double reach = 0.0;
    for (const Vec3& c : t) reach = std::max(reach, (c - middle).norm());
    const double inside = inside_mm(region, middle, face);
    if (inside < -reach - rim_step_mm) return;
    const double longest = 2.0 * reach;
    const bool is_deep = inside > rim_mm + reach;
    if (longest <= rim_step_mm || (is_deep && longest <= step_mm)) {
      if (inside >= 0.0) visit(middle, 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).norm());
      return;
    }
    std::size_t s = 0;  // The search begins with the longest side.
    for (std::size_t k = 1; k < 3; ++k) {
      if ((t[(k + 1) % 3] - t[k]).norm() > (t[(s + 1) % 3] - t[s]).norm()) s = k;
    }
    const Vec3 half = 0.5 * (t[s] + t[(s + 1) % 3]);
    divide({t[s], half, t[(s + 2) % 3]}, face);
    divide({half, t[(s + 1) % 3], t[(s + 2) % 3]}, face);
  };
  for (FaceIndex f{0}; f < static_cast<int>(mesh.faces.size()); ++f) {
    if (!groups_[region].holds.empty() && !groups_[region].holds[at(f)]) continue;
    const auto& v = mesh.faces[at(f)];
    divide({mesh.vertices[at(v[0])], mesh.vertices[at(v[1])], mesh.vertices[at(v[2])]}, f);
  }
}

double SurfaceRegions::weight_at(const Vec3& center_mm) const {
  if (!has_weights_) return 1.0;
  const SurfacePoint foot = surface_.closest(center_mm);
  for (std::size_t k = regions_.list.size(); k-- > 0;) {
    const design::Region& r = regions_.list[k];
    if (!r.weight) continue;
    const bool holds = groups_[k].holds.empty() ? inside_mm(k, foot.position_mm, foot.face) >= 0.0
                                                : groups_[k].holds[at(foot.face)] != 0;
    if (holds) return *r.weight;
  }
  return regions_.elsewhere;
}

// If the middle of a part of the module reaches in by x, no point of it can reach in by more than x + kStretch · its
// radius.
double SurfaceRegions::keep_out_mm(const std::array<Vec3, 3>& corner_mm, double corner_cut_mm) const {
  double deepest = 0.0;
  const Vec3 center = (corner_mm[0] + corner_mm[1] + corner_mm[2]) / 3.0;
  for (std::size_t k = 0; k < regions_.list.size(); ++k) {
    if (!regions_.list[k].free) continue;
    const auto inside = [&](const Vec3& p) {
      const SurfacePoint foot = surface_.closest(p);
      return inside_mm(k, foot.position_mm, foot.face);
    };
    if (inside(center) < -kStretch * kModuleRadius_mm) continue;
    const double step_mm = bodies_[k] ? kBodyReachStep_mm : kReachStep_mm;
    const std::function<void(const std::array<Vec3, 3>&)> search = [&](const std::array<Vec3, 3>& part) {
      const Vec3 middle = (part[0] + part[1] + part[2]) / 3.0;
      double reach = 0.0;
      for (const Vec3& c : part) reach = std::max(reach, (c - middle).norm());
      const double here = inside(middle);
      deepest = std::max(deepest, here);
      if (here + kStretch * reach <= deepest + step_mm + kReachPart * std::max(0.0, deepest - 1.0)) return;
      const Vec3 ab = 0.5 * (part[0] + part[1]), bc = 0.5 * (part[1] + part[2]), ca = 0.5 * (part[2] + part[0]);
      for (const auto& quarter : {std::array{part[0], ab, ca}, std::array{part[1], bc, ab}, std::array{part[2], ca, bc},
                                  std::array{ab, bc, ca}})
        search(quarter);
    };
    const design::Outline outline = design::outline_of(corner_mm, corner_cut_mm);
    const auto points = outline.points();
    for (std::size_t c = 1; c + 1 < points.size(); ++c) search({points[0], points[c], points[c + 1]});
  }
  return deepest;
}

std::vector<SurfaceRegions::MustCover> SurfaceRegions::must_cover(double step_mm) const {
  std::vector<MustCover> places;
  for (std::size_t k = 0; k < regions_.list.size(); ++k) {
    const design::Region& r = regions_.list[k];
    if (!r.cover) continue;
    const std::size_t first = places.size();
    double area = 0.0;
    // A smaller step finds a region that is smaller than the first one.
    for (double step = step_mm; places.size() == first && step > 0.01; step *= 0.5) {
      sample(k, step, step, 0.0, [&](const Vec3& p, double share) {
        places.push_back({p, static_cast<int>(k), r.within_mm, share});
        area += share;
      });
    }
    for (std::size_t p = first; p < places.size(); ++p) places[p].share /= area;
  }
  return places;
}

std::vector<design::Uncovered> SurfaceRegions::uncovered(const ModuleLayout& layout) const {
  return uncovered(layout, kCoverStep_mm);
}

std::vector<design::Uncovered> SurfaceRegions::uncovered(const ModuleLayout& layout, double step_mm) const {
  std::vector<const PlacedModule*> along_x;
  for (const PlacedModule& m : layout.modules) along_x.push_back(&m);
  const auto x_of = [](const PlacedModule* m) { return m->corner_mm[0].x(); };
  std::ranges::sort(along_x, {}, x_of);
  std::vector<design::Uncovered> of_region(regions_.list.size());
  for (const MustCover& place : must_cover(step_mm)) {
    double distance = kFar;
    const double x = place.point_mm.x();
    for (auto m = std::ranges::lower_bound(along_x, x - kBeside_mm, {}, x_of);
         m != along_x.end() && x_of(*m) < x + kBeside_mm && distance > 0.0; ++m) {
      if (((*m)->corner_mm[0] - place.point_mm).norm() < kBeside_mm)
        distance = std::min(distance, distance_beside((*m)->corner_mm, layout.corner_cut_mm, place.point_mm));
    }
    if (distance <= place.within_mm) continue;
    design::Uncovered& u = of_region[at(place.region)];
    u.region = regions_.list[at(place.region)].name;
    u.share += place.share;
    if (distance <= u.distance_mm) continue;
    u.distance_mm = distance;
    u.place_mm = place.point_mm;
  }
  std::erase_if(of_region, [](const design::Uncovered& u) { return u.region.empty(); });
  return of_region;
}

double SurfaceRegions::weight_of(const ModuleLayout& layout) const {
  double sum = 0.0;
  for (const PlacedModule& m : layout.modules)
    sum += weight_at((m.corner_mm[0] + m.corner_mm[1] + m.corner_mm[2]) / 3.0);
  return sum;
}

double SurfaceRegions::module_value(const ModuleLayout& layout) const {
  double sum = weight_of(layout);
  for (const design::Uncovered& u : uncovered(layout, kWorthStep_mm)) sum -= kUncoveredCost * u.share;
  return sum;
}

double distance_beside(const std::array<Vec3, 3>& corner_mm, double corner_cut_mm, const Vec3& place_mm) {
  const Vec3 n = (corner_mm[1] - corner_mm[0]).cross(corner_mm[2] - corner_mm[0]).normalized();
  const double height = (place_mm - corner_mm[0]).dot(n);
  if (std::abs(height) > kSheet_mm) return kFar;
  const Vec3 p = place_mm - height * n;
  const design::Outline outline = design::outline_of(corner_mm, corner_cut_mm);
  const auto points = outline.points();
  double least = kFar;
  bool is_inside = true;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec3 &a = points[k], &b = points[(k + 1) % points.size()];
    least = std::min(least, geometry::distance_to_segment(p, a, b));
    is_inside = is_inside && n.cross(b - a).dot(p - a) >= 0.0;
  }
  return is_inside ? 0.0 : least;
}

}  // namespace triskin::mesh
