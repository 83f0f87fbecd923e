// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the distance between two sets of triangles with a proved upper bound: the distance to one triangle is
// convex, so over any triangles it is at most that of their farthest corner. Whole sets of triangles are bounded first
// and divided only where their bound is above a distance that is known to occur, so the search may end at any time with
// both.
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "dropped_parts.hpp"
#include "triangle_tree.hpp"
#include "triskin/base/index.hpp"
#include "triskin/geometry/triangle.hpp"
#include "triskin/mesh/extract_steps.hpp"

namespace triskin::mesh {
namespace {

constexpr double kTolerance_mm = 0.02;  // The stated bound may exceed the largest distance by this much.
// After this many divisions of triangles the bound is coarser, but it remains a bound.
constexpr int kMaxDivisions = 40'000;
constexpr std::size_t kBatch = 64;  // At least this many are divided side by side.
// The clock is not read before, so that the bound is no guess; this takes some 0.1 s.
constexpr std::size_t kMinSteps = 20'000;
// Missing areas are resolved to this, or coarser so that about this many pieces are looked at.
constexpr double kMissing_mm2 = 0.05, kMaxMissingPieces = 40'000.0;
constexpr double kMinPart_mm2 = 1.0;          // Smaller parts are left to the deviation; a module has 390 mm².
constexpr std::size_t kMeanSamples = 20'000;  // The mean is sampled at the middles of this many triangles.

using geometry::Triangle, geometry::area_of;

Vec3 middle_of(const Triangle& t) {
  return (t[0] + t[1] + t[2]) / 3.0;
}

// Holds an upper bound and a least value of the distances of all points of some triangles, and the distance of one.
struct Bounds {
  double upper = std::numeric_limits<double>::infinity(), least = 0.0, lower = 0.0;
  Vec3 lower_at = Vec3::Zero();
};

// Measures from the faces that `wanted` selects in one mesh to another mesh. A triangle that both meshes have counts as
// 0.
class Way {
 public:
  Way(const Mesh& from, const std::vector<bool>& wanted, const Mesh& to) : to_(to) {
    const Triangles same(to);
    for (FaceIndex f{0}; f < static_cast<int>(from.faces.size()); ++f) {
      if (!wanted[at(f)]) continue;
      const Triangle t = triangle_of(from, f);
      area_ += area_of(t);
      if (same.contains(t)) continue;
      changed_.push_back(t);
      changed_faces_.push_back(f);
    }
  }

  [[nodiscard]] std::span<Triangle> changed() { return changed_; }
  /// Numbers the changed triangles in the mesh, as long as changed() was not reordered.
  [[nodiscard]] const std::vector<FaceIndex>& changed_faces() const { return changed_faces_; }

  // Returns the mean over the area from the middles of the changed triangles, or from a sample at even steps of area if
  // there are many.
  [[nodiscard]] double mean() const {
    std::vector<double> until;  // Running sum of the area of the changed triangles.
    double sum = 0.0;
    for (const Triangle& t : changed_) until.push_back(sum += area_of(t));
    if (!(sum > 0.0)) return 0.0;
    const bool all = changed_.size() <= kMeanSamples;
    std::vector<double> part(all ? changed_.size() : kMeanSamples);
    tbb::parallel_for(std::size_t{0}, part.size(), [&](std::size_t k) {
      const double step = sum / static_cast<double>(part.size());
      const auto sampled = std::ranges::upper_bound(until, (static_cast<double>(k) + 0.5) * step) - until.begin();
      const std::size_t n = all ? k : std::min(static_cast<std::size_t>(sampled), changed_.size() - 1);
      part[k] = to_.closest(middle_of(changed_[n])).distance_mm * (all ? area_of(changed_[n]) : step);
    });
    double total = 0.0;
    for (const double p : part) total += p;
    return total / area_;
  }

  // Bounds one triangle; ends early when the bound is at most `enough`.
  [[nodiscard]] Bounds bounds_of(const Triangle& t, double enough) const {
    Bounds b;
    look_from(middle_of(t), {&t, 1}, b);
    for (std::size_t k = 0; k < 3 && b.upper > enough; ++k) look_from(t[k], {&t, 1}, b);
    return b;
  }
  // Bounds several triangles, starting from the corner nearest to the middle of their box.
  [[nodiscard]] Bounds bounds_of(std::span<const Triangle> triangles) const {
    Eigen::AlignedBox3d box;
    for (const Triangle& t : triangles) box.extend(t[0]).extend(t[1]).extend(t[2]);
    Vec3 nearest = triangles[0][0];
    for (const Triangle& t : triangles) {
      for (const Vec3& corner : t) {
        if ((corner - box.center()).squaredNorm() < (nearest - box.center()).squaredNorm()) nearest = corner;
      }
    }
    Bounds b;
    look_from(nearest, triangles, b);
    return b;
  }

 private:
  // Measures one point and derives a bound for all: no point is farther than that distance plus the way to it, nor than
  // the farthest corner from the face that was nearest.
  void look_from(const Vec3& point, std::span<const Triangle> triangles, Bounds& b) const {
    const SurfacePoint found = to_.closest(point);
    const Triangle face = triangle_of(to_.mesh(), found.face);
    double way = 0.0, most = 0.0;
    for (const Triangle& t : triangles) {
      for (const Vec3& corner : t) {
        way = std::max(way, (corner - point).norm());
        most = std::max(most, geometry::distance_to_triangle(corner, face));
      }
    }
    b.upper = std::min({b.upper, most, found.distance_mm + way});
    b.least = std::max(b.least, found.distance_mm - way);
    if (found.distance_mm < b.lower) return;
    b.lower = found.distance_mm;
    b.lower_at = point;
  }

  TriangleTree to_;
  std::vector<Triangle> changed_;
  std::vector<FaceIndex> changed_faces_;
  double area_ = 0.0;
};

// An open item of the search: several faces of a mesh, or one triangle that may be a part of a face.
struct Open {
  // The bound of the triangle from which this part was cut holds here too.
  double upper = std::numeric_limits<double>::infinity();
  const Way* way = nullptr;
  std::span<Triangle> faces{};  // An item with a single face keeps it in `part`.
  Triangle part{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
};

std::array<Triangle, 4> quarters_of(const Triangle& t) {
  const Vec3 ab = 0.5 * (t[0] + t[1]), bc = 0.5 * (t[1] + t[2]), ca = 0.5 * (t[2] + t[0]);
  return {Triangle{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}};
}

// Returns the area of the triangle farther than within_mm from the other mesh; what lies at the limit is divided down
// to smallest_mm2.
double missing_mm2(const Way& way, const Triangle& t, double within_mm, double smallest_mm2) {
  const Bounds bounds = way.bounds_of(t, within_mm);
  if (bounds.upper <= within_mm) return 0.0;
  if (bounds.least > within_mm) return area_of(t);
  if (area_of(t) <= smallest_mm2) return bounds.lower > within_mm ? area_of(t) : 0.0;
  double sum = 0.0;
  for (const Triangle& part : quarters_of(t)) sum += missing_mm2(way, part, within_mm, smallest_mm2);
  return sum;
}

// Splits faces into two halves along the longest side of their box, and a single triangle into four.
void divide(const Open& open, std::vector<Open>& parts) {
  const auto add_part = [&](const Triangle& t) { parts.push_back({.upper = open.upper, .way = open.way, .part = t}); };
  if (open.faces.empty()) {
    for (const Triangle& part : quarters_of(open.part)) add_part(part);
    return;
  }
  if (open.faces.size() <= 4) {
    for (const Triangle& t : open.faces) add_part(t);
    return;
  }
  Eigen::AlignedBox3d box;
  for (const Triangle& t : open.faces) box.extend(middle_of(t));
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::size_t half = open.faces.size() / 2;
  std::ranges::nth_element(open.faces, open.faces.begin() + static_cast<std::ptrdiff_t>(half), {},
                           [axis](const Triangle& t) { return t[0][axis] + t[1][axis] + t[2][axis]; });
  parts.push_back({.upper = open.upper, .way = open.way, .faces = open.faces.first(half)});
  parts.push_back({.upper = open.upper, .way = open.way, .faces = open.faces.subspan(half)});
}

// Branch and bound over the triangles of both ways: the item with the largest bound is divided until no bound exceeds a
// distance that is known to occur, or the time is over.
class Search {
 public:
  void add(Way& way) {
    if (way.changed().empty()) return;
    std::vector<Open> all;
    if (way.changed().size() > 1)
      all.push_back({.way = &way, .faces = way.changed()});
    else
      all.push_back({.way = &way, .part = way.changed()[0]});
    take(std::move(all));
  }

  void run(const IsLate& is_late) {
    std::size_t steps = 0;
    for (int divisions = 0; divisions < kMaxDivisions;) {
      if (steps > kMinSteps && is_late && is_late()) break;
      std::vector<Open> parts;
      const std::size_t batch = std::max(kBatch, open_.size() / 16);
      std::size_t taken = 0;
      for (; taken < batch && !open_.empty() && open_.top().upper > known_ + kTolerance_mm; ++taken) {
        const Open open = open_.top();
        open_.pop();
        divisions += open.faces.empty() ? 1 : 0;
        divide(open, parts);
      }
      if (taken == 0) break;
      steps += parts.size();
      take(std::move(parts));
    }
    if (!open_.empty()) bound_ = std::max(bound_, open_.top().upper);
  }

  [[nodiscard]] double bound() const { return bound_; }
  [[nodiscard]] double known() const { return known_; }
  [[nodiscard]] const Vec3& known_at() const { return known_at_; }

 private:
  void take(std::vector<Open> parts) {
    std::vector<Bounds> bounds(parts.size());
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t k) {
      const Open& p = parts[k];
      bounds[k] = p.faces.empty() ? p.way->bounds_of(p.part, known_ + kTolerance_mm) : p.way->bounds_of(p.faces);
    });
    for (const Bounds& b : bounds) {
      if (b.lower <= known_) continue;
      known_ = b.lower;
      known_at_ = b.lower_at;
    }
    for (std::size_t k = 0; k < parts.size(); ++k) {
      parts[k].upper = std::min(parts[k].upper, bounds[k].upper);
      if (parts[k].upper > known_ + kTolerance_mm)
        open_.push(parts[k]);
      else
        bound_ = std::max(bound_, parts[k].upper);
    }
  }

  struct Less {
    bool operator()(const Open& a, const Open& b) const { return a.upper < b.upper; }
  };
  std::priority_queue<Open, std::vector<Open>, Less> open_;
  double known_ = 0.0, bound_ = 0.0;
  Vec3 known_at_ = Vec3::Zero();
};

}  // namespace

Deviation deviation_between(const Mesh& input, const std::vector<bool>& outside, const Mesh& result,
                            const IsLate& is_late) {
  Way there(input, outside, result), back(result, std::vector<bool>(result.faces.size(), true), input);
  Deviation d;
  d.mean_mm = std::max(there.mean(), back.mean());
  Search search;
  search.add(back);
  search.add(there);
  search.run(is_late);
  d.largest_mm = search.bound();
  d.found_mm = search.known();
  d.where_mm = search.known_at();
  return d;
}

std::vector<DroppedPart> parts_beyond(const Mesh& input, const std::vector<bool>& counted, const Mesh& result,
                                      double within_mm) {
  std::vector<bool> others(counted.size());
  for (std::size_t f = 0; f < others.size(); ++f) others[f] = !counted[f];
  Way way(input, others, result);
  std::vector<char> is_beyond(way.changed().size());
  tbb::parallel_for(std::size_t{0}, is_beyond.size(), [&](std::size_t k) {
    is_beyond[k] = way.bounds_of(way.changed()[k], within_mm).upper > within_mm;
  });
  std::vector<bool> is_dropped(input.faces.size());
  for (std::size_t k = 0; k < is_beyond.size(); ++k) is_dropped[at(way.changed_faces()[k])] = is_beyond[k] != 0;
  return parts_of_faces(input, is_dropped);
}

std::vector<DroppedPart> missing_parts(const Mesh& input, const std::vector<bool>& counted, const Mesh& result,
                                       double within_mm) {
  Way way(input, counted, result);
  double changed_mm2 = 0.0;
  for (const Triangle& t : way.changed()) changed_mm2 += area_of(t);
  const double smallest_mm2 = std::max(kMissing_mm2, changed_mm2 / kMaxMissingPieces);
  std::vector<double> missing(way.changed().size());
  tbb::parallel_for(std::size_t{0}, missing.size(),
                    [&](std::size_t k) { missing[k] = missing_mm2(way, way.changed()[k], within_mm, smallest_mm2); });
  std::vector<std::optional<double>> of_face(input.faces.size());
  for (std::size_t k = 0; k < missing.size(); ++k) {
    if (missing[k] > 0.0) of_face[at(way.changed_faces()[k])] = missing[k];
  }
  std::vector<DroppedPart> parts = parts_of_faces(input, of_face);
  std::erase_if(parts, [](const DroppedPart& part) { return part.area_mm2 < kMinPart_mm2; });
  return parts;
}

}  // namespace triskin::mesh
