// SPDX-License-Identifier: GPL-3.0-or-later
#include "side_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "outside_view.hpp"
#include "triskin/base/index.hpp"
#include "triskin/base/parallel.hpp"

namespace triskin::mesh {
namespace {

constexpr int kRays = 32;
constexpr int kViews = 6'000;  // The view is taken from this many samples.
constexpr int kMinViewsPerRegion = 6;
constexpr std::size_t kChunk = 16;
// Even across a thick body the other side still shows which one is a pocket.
constexpr double kFarthestOpposite_mm = 60.0;
// A smaller depth comes from the chord of a facet, or from the play of a lid.
constexpr double kMinDepthScale_mm = 1.0;
// The views of the two sides of a lid differ by some hundredths; a quarter is a difference beyond doubt.
constexpr double kVisibilityGain = 4.0;
// Both sides of a rib see a third to a half of the sky; the outer side of a cover sees more.
constexpr double kRibVisibility = 0.35, kOpenVisibility = 0.65;
constexpr double kHiddenOutwardness = -0.5;
// A lid that is sunk into its frame lies less deep than this under the frame's rim.
constexpr double kEnclosed_mm = 3.0;
constexpr std::size_t kMaxEnclosing = 8;  // Only the largest components are tested for enclosing another one.

struct View {
  double visibility = 0.0;
  double depth_mm = 0.0;        // The depth is under the hull of its own component.
  double whole_depth_mm = 0.0;  // The depth is under the hull of all components.
};

// One sample's evidence for its side, and how much of its area counts.
struct Opinion {
  double outwardness = 0.0, weight = 0.0;
  View here;
};

std::vector<int> components_of(const std::vector<std::array<FaceIndex, 3>>& neighbours, std::vector<bool>& is_closed) {
  std::vector<int> component(neighbours.size(), -1);
  for (std::size_t first = 0; first < neighbours.size(); ++first) {
    if (component[first] >= 0) continue;
    const int id = static_cast<int>(is_closed.size());
    is_closed.push_back(true);
    std::vector<FaceIndex> queue{FaceIndex(first)};
    component[first] = id;
    for (std::size_t q = 0; q < queue.size(); ++q) {
      for (const FaceIndex n : neighbours[at(queue[q])]) {
        if (n < 0) is_closed[at(id)] = false;
        if (n < 0 || component[at(n)] >= 0) continue;
        component[at(n)] = id;
        queue.push_back(n);
      }
    }
  }
  return component;
}

// Returns a positive value if the first is nearer to the hull.
double contrast(double here_mm, double there_mm, double scale_mm) {
  return (there_mm - here_mm) / (there_mm + here_mm + scale_mm);
}

std::vector<HullDepth> hulls_of(const Mesh& mesh, const std::vector<int>& component, std::size_t count) {
  std::vector<std::vector<Vec3>> points(count);
  std::vector<int> last_of_vertex(mesh.vertices.size(), -1);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (const int v : mesh.faces[f]) {
      if (last_of_vertex[at(v)] == component[f]) continue;
      last_of_vertex[at(v)] = component[f];
      points[at(component[f])].push_back(mesh.vertices[at(v)]);
    }
  }
  std::vector<HullDepth> hulls;
  for (const auto& p : points) hulls.emplace_back(p);
  return hulls;
}

class Evidence {
 public:
  Evidence(const RayCaster& part, const std::vector<std::array<FaceIndex, 3>>& neighbours, const SmoothRegions& regions,
           const std::vector<WallSample>& samples, const SideOptions& options)
      : part_(part), neighbours_(neighbours), regions_(regions), samples_(samples), options_(options) {}

  SideEvidence run() {
    component_ = components_of(neighbours_, found_.is_component_closed);
    hulls_ = hulls_of(part_.mesh(), component_, found_.is_component_closed.size());
    find_enclosed();
    if (hulls_.size() > 1) hulls_.emplace_back(part_.mesh().vertices);
    found_.regions.resize(at(regions_.count));
    measure_regions();
    measure_borders();
    gather_views();
    return std::move(found_);
  }

 private:
  [[nodiscard]] int region(FaceIndex face) const { return regions_.of_face[at(face)]; }

  // An open sheet has no inside: parts in its hull may be other sheets of the same surface.
  void find_enclosed() {
    found_.is_component_enclosed.assign(hulls_.size(), false);
    std::vector<std::size_t> largest;
    for (std::size_t c = 0; c < hulls_.size(); ++c) {
      if (found_.is_component_closed[c]) largest.push_back(c);
    }
    std::vector<double> size;
    for (const HullDepth& hull : hulls_) size.push_back(hull.mean_height_mm());
    const std::size_t few = std::min(largest.size(), kMaxEnclosing);
    std::ranges::partial_sort(largest, largest.begin() + static_cast<std::ptrdiff_t>(few), std::greater{},
                              [&](std::size_t c) { return size[c]; });
    for (std::size_t c = 0; c < hulls_.size(); ++c) {
      found_.is_component_enclosed[c] =
          found_.is_component_closed[c] &&
          std::any_of(largest.begin(), largest.begin() + static_cast<std::ptrdiff_t>(few),
                      [&](std::size_t o) { return hulls_[o].encloses(hulls_[c], kEnclosed_mm); });
    }
  }

  void measure_regions() {
    // Each pair is a thickness and the area that has it.
    std::vector<std::vector<std::pair<double, double>>> walls(at(regions_.count));
    for (const WallSample& s : samples_) {
      const int r = region(s.face);
      RegionEvidence& e = found_.regions[at(r)];
      e.component = component_[at(s.face)];
      e.area_mm2 += s.area_mm2;
      if (s.partner < 0) continue;
      e.walled_mm2 += s.area_mm2;
      walls[at(r)].emplace_back(s.wall_mm, s.area_mm2);
      if (const int other = region(s.partner); other == r) {
        e.self_mm2 += s.area_mm2;
      } else {
        found_.across_mm2[std::minmax(r, other)] += 0.5 * s.area_mm2;
      }
    }
    for (std::size_t r = 0; r < walls.size(); ++r) found_.regions[r].wall_mm = median(walls[r]);
  }

  static double median(std::vector<std::pair<double, double>>& weighted) {
    std::ranges::sort(weighted);
    double left = 0.0;
    for (const auto& [value, weight] : weighted) left += 0.5 * weight;
    for (const auto& [value, weight] : weighted) {
      left -= weight;
      if (left <= 0.0) return value;
    }
    return 0.0;
  }

  void measure_borders() {
    for (std::size_t f = 0; f < neighbours_.size(); ++f) {
      for (std::size_t s = 0; s < 3; ++s) {
        const FaceIndex n = neighbours_[f][s];
        const int r = regions_.of_face[f];
        if (n >= 0 && region(n) == r) continue;
        const double length = part_.edge_mm(f, s);
        found_.regions[at(r)].border_mm += length;
        if (n > static_cast<int>(f)) found_.beside_mm[std::minmax(r, region(n))] += length;
      }
    }
  }

  // Samples are spread evenly by area within each region, with at least a few in each.
  [[nodiscard]] std::vector<int> viewed_samples() const {
    double total = 0.0;
    for (const RegionEvidence& e : found_.regions) total += e.area_mm2;
    std::vector<double> step, next;
    for (const RegionEvidence& e : found_.regions) {
      step.push_back(std::min(total / kViews, e.area_mm2 / kMinViewsPerRegion));
      next.push_back(0.5 * step.back());
    }
    std::vector<int> viewed;
    std::vector<double> passed(found_.regions.size(), 0.0);
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      const std::size_t r = at(region(samples_[k].face));
      passed[r] += samples_[k].area_mm2;
      if (passed[r] < next[r]) continue;
      viewed.push_back(static_cast<int>(k));
      while (next[r] <= passed[r]) next[r] += std::max(step[r], 1e-9);
    }
    return viewed;
  }

  [[nodiscard]] View view(const Vec3& point, FaceIndex face, unsigned turn) const {
    const Vec3& normal = part_.normal(face);
    const double depth = hulls_[at(component_[at(face)])].along(point, normal);
    return {visibility_of(part_, point, normal, kRays, turn), depth,
            hulls_.size() > 1 ? hulls_.back().along(point, normal) : depth};
  }

  [[nodiscard]] bool is_seen(const Vec3& point, FaceIndex face) const {
    const Vec3 sight = *options_.from_mm - point;
    const double distance = sight.norm();
    if (sight.dot(part_.normal(face)) <= 0.0) return false;
    return part_.is_free(point + 0.05 * part_.normal(face), sight / distance, distance);
  }

  [[nodiscard]] Opinion opinion(const WallSample& s, unsigned turn) const {
    const Vec3& normal = part_.normal(s.face);
    Opinion o;
    if (normal.isZero()) return o;
    o.here = view(s.point_mm, s.face, turn);
    FaceIndex partner = s.partner;
    double thickness = s.wall_mm;
    if (partner < 0) {
      const RayHit hit = part_.first_hit(s.point_mm, -normal, options_.min_wall_mm, kFarthestOpposite_mm, s.face);
      if (hit.face < 0 || part_.normal(hit.face).dot(normal) > -0.8) return o;
      partner = hit.face;
      thickness = hit.distance_mm;
    }
    const Vec3 opposite = s.point_mm - thickness * normal;
    o.weight = std::pow(std::min(1.0, options_.max_wall_mm / std::max(thickness, 1e-9)), 2);
    if (options_.from_mm) {
      o.outwardness = (is_seen(s.point_mm, s.face) ? 1.0 : 0.0) - (is_seen(opposite, partner) ? 1.0 : 0.0);
      return o;
    }
    const View there = view(opposite, partner, turn);
    const double scale = std::max(kMinDepthScale_mm, std::min(thickness, options_.max_wall_mm));
    const double by_depth = 0.5 * (contrast(o.here.depth_mm, there.depth_mm, scale) +
                                   contrast(o.here.whole_depth_mm, there.whole_depth_mm, scale));
    const double by_view = std::clamp(kVisibilityGain * (o.here.visibility - there.visibility), -1.0, 1.0);
    const double open = std::clamp(
        (std::max(o.here.visibility, there.visibility) - kRibVisibility) / (kOpenVisibility - kRibVisibility), 0.0,
        1.0);
    o.outwardness = open * 0.5 * (by_depth + by_view) + (1.0 - open) * kHiddenOutwardness;
    return o;
  }

  void gather_views() {
    const std::vector<int> viewed = viewed_samples();
    std::vector<Opinion> opinions(viewed.size());
    in_parallel(options_.threads, (viewed.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
      const std::size_t end = std::min(viewed.size(), (chunk + 1) * kChunk);
      for (std::size_t k = chunk * kChunk; k < end; ++k)
        opinions[k] = opinion(samples_[at(viewed[k])], static_cast<unsigned>(k));
    });
    std::vector<double> count(found_.regions.size(), 0.0), weight = count, outwardness = count, visibility = count,
                                                           depth = count;
    for (std::size_t k = 0; k < viewed.size(); ++k) {
      const std::size_t r = at(region(samples_[at(viewed[k])].face));
      count[r] += 1.0;
      weight[r] += opinions[k].weight;
      outwardness[r] += opinions[k].weight * opinions[k].outwardness;
      visibility[r] += opinions[k].here.visibility;
      depth[r] += opinions[k].here.depth_mm;
    }
    for (std::size_t r = 0; r < count.size(); ++r) {
      if (count[r] == 0.0) continue;
      RegionEvidence& e = found_.regions[r];
      e.visibility = visibility[r] / count[r];
      e.hull_depth_mm = depth[r] / count[r];
      if (weight[r] > 0.0) e.outwardness = outwardness[r] / weight[r];
      e.outwardness_mm2 = e.area_mm2 * weight[r] / count[r];
    }
  }

  const RayCaster& part_;
  const std::vector<std::array<FaceIndex, 3>>& neighbours_;
  const SmoothRegions& regions_;
  const std::vector<WallSample>& samples_;
  const SideOptions& options_;
  std::vector<int> component_;
  std::vector<HullDepth> hulls_;
  SideEvidence found_;
};

}  // namespace

SideEvidence side_evidence(const RayCaster& part, const std::vector<std::array<FaceIndex, 3>>& neighbours,
                           const SmoothRegions& regions, const std::vector<WallSample>& samples,
                           const SideOptions& options) {
  return Evidence(part, neighbours, regions, samples, options).run();
}

}  // namespace triskin::mesh
