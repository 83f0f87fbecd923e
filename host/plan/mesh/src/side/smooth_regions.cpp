// SPDX-License-Identifier: GPL-3.0-or-later
#include "smooth_regions.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <tuple>

#include "triskin/base/disjoint_sets.hpp"
#include "triskin/base/index.hpp"

namespace triskin::mesh {
namespace {

// A cylinder of 11 facets turns by 33° from facet to facet, and the chamfer of an edge by 45°. The limit is the
// cosine of 35°, the sharpest turn of an edge that counts as smooth.
constexpr double kSmoothCosine = 0.82;
// At the cosine of 20° a rim of few facets separates the sides, and most rounded surfaces still hang together.
constexpr double kStrictCosine = 0.94;
constexpr double kMaxTurnCosine = 0.766;  // The cosine of 40°, which is less than half of a rounded rim.
// At the cosine of 50°, regions that meet above a rib are joined, and those across a rim are not.
constexpr double kJoinedTurnCosine = 0.64;
constexpr double kWalled = 0.5;
constexpr double kNeedleHeight_mm = 0.01;  // The normal of a lower triangle consists mostly of rounding errors.
constexpr int kNeedlePasses = 4;

class Division {
 public:
  Division(const RayCaster& part, const std::vector<std::array<FaceIndex, 3>>& neighbours,
           const std::vector<double>& walled, double smooth_cosine)
      : neighbours_(neighbours),
        walled_(walled),
        smooth_cosine_(smooth_cosine),
        sets_(neighbours.size()),
        source_(neighbours.size(), Vec3::Zero()) {
    for (std::size_t f = 0; f < neighbours.size(); ++f) normals_.push_back(part.normal(FaceIndex(f)));
    smooth_needles(part);
  }

  SmoothRegions run() {
    join_where([&](FaceIndex a, FaceIndex b) { return has_wall(a) && has_wall(b); });
    grow();
    join_where([&](FaceIndex a, FaceIndex b) {
      return is_reached(a) && is_reached(b) && turn(source_, a, b) > kJoinedTurnCosine;
    });
    join_where([&](FaceIndex a, FaceIndex b) { return !is_reached(a) && !is_reached(b); });
    return numbered();
  }

 private:
  [[nodiscard]] bool has_wall(FaceIndex f) const { return walled_[at(f)] >= kWalled; }
  [[nodiscard]] bool is_reached(FaceIndex f) const { return !source_[at(f)].isZero(); }
  [[nodiscard]] static double turn(const std::vector<Vec3>& normals, FaceIndex a, FaceIndex b) {
    return normals[at(a)].dot(normals[at(b)]);
  }
  [[nodiscard]] bool is_smooth(FaceIndex a, FaceIndex b) const { return turn(normals_, a, b) > smooth_cosine_; }

  // A needle takes the normal of the face across its longest side, so that it separates nothing.
  void smooth_needles(const RayCaster& part) {
    for (int pass = 0; pass < kNeedlePasses; ++pass) {
      for (std::size_t f = 0; f < normals_.size(); ++f) {
        std::size_t longest = 0;
        double length = 0.0;
        for (std::size_t s = 0; s < 3; ++s) {
          const double l = part.edge_mm(f, s);
          if (l > length) std::tie(length, longest) = std::tuple(l, s);
        }
        const FaceIndex beyond = neighbours_[f][longest];
        if (beyond >= 0 && 2.0 * part.area_mm2(FaceIndex(f)) < kNeedleHeight_mm * length)
          normals_[f] = normals_[at(beyond)];
      }
    }
  }

  void join_where(const std::function<bool(FaceIndex, FaceIndex)>& wanted) {
    for (std::size_t f = 0; f < neighbours_.size(); ++f) {
      for (const FaceIndex n : neighbours_[f]) {
        const FaceIndex face(f);
        if (n > face && is_smooth(face, n) && wanted(face, n)) sets_.join(n, face);
      }
    }
  }

  // Grows best first: a face joins the region from which it turns least.
  void grow() {
    // A step has the cosine of the turn, the face, and the face from which it is reached.
    using Step = std::tuple<double, FaceIndex, FaceIndex>;
    std::priority_queue<Step, std::vector<Step>, std::less<>> queue;
    const auto look_around = [&](FaceIndex f) {
      for (const FaceIndex n : neighbours_[at(f)]) {
        if (n < 0 || is_reached(n) || has_wall(n) || !is_smooth(f, n)) continue;
        const double cosine = normals_[at(n)].dot(source_[at(f)]);
        if (cosine > kMaxTurnCosine) queue.emplace(cosine, n, f);
      }
    };
    for (std::size_t f = 0; f < walled_.size(); ++f) {
      if (has_wall(FaceIndex(f))) source_[f] = normals_[f];
    }
    for (std::size_t f = 0; f < walled_.size(); ++f) {
      if (has_wall(FaceIndex(f))) look_around(FaceIndex(f));
    }
    while (!queue.empty()) {
      const auto [cosine, face, from] = queue.top();
      queue.pop();
      if (is_reached(face)) continue;
      source_[at(face)] = source_[at(from)];
      sets_.join(face, from);
      look_around(face);
    }
  }

  SmoothRegions numbered() {
    SmoothRegions regions;
    std::vector<int> number(neighbours_.size(), -1);
    for (std::size_t f = 0; f < neighbours_.size(); ++f) {
      int& n = number[at(sets_.find(static_cast<int>(f)))];
      if (n < 0) n = regions.count++;
      regions.of_face.push_back(n);
    }
    return regions;
  }

  const std::vector<std::array<FaceIndex, 3>>& neighbours_;
  const std::vector<double>& walled_;
  double smooth_cosine_;
  DisjointSets sets_;
  std::vector<Vec3> source_, normals_;  // The source is the normal of the walled face from which a face was reached.
};

bool is_mostly_its_own_partner(const SmoothRegions& regions, const std::vector<WallSample>& samples) {
  double own = 0.0, all = 0.0;
  for (const WallSample& s : samples) {
    if (s.partner < 0) continue;
    all += s.area_mm2;
    if (regions.of_face[at(s.face)] == regions.of_face[at(s.partner)]) own += s.area_mm2;
  }
  return own > 0.5 * all;
}

// Tells whether most of the area lies in regions that are wide for their border.
bool is_mostly_wide(const RayCaster& part, const std::vector<std::array<FaceIndex, 3>>& neighbours,
                    const SmoothRegions& regions) {
  std::vector<double> area(at(regions.count), 0.0), border = area;
  for (std::size_t f = 0; f < neighbours.size(); ++f) {
    const std::size_t region = at(regions.of_face[f]);
    area[region] += part.area_mm2(FaceIndex(f));
    for (std::size_t s = 0; s < 3; ++s) {
      const FaceIndex n = neighbours[f][s];
      if (n >= 0 && at(regions.of_face[at(n)]) == region) continue;
      border[region] += part.edge_mm(f, s);
    }
  }
  double wide = 0.0, all = 0.0;
  for (std::size_t r = 0; r < area.size(); ++r) {
    all += area[r];
    if (!is_narrow(area[r], border[r])) wide += area[r];
  }
  return wide > 0.5 * all;
}

}  // namespace

SmoothRegions smooth_regions(const RayCaster& part, const std::vector<std::array<FaceIndex, 3>>& neighbours,
                             const std::vector<WallSample>& samples) {
  const std::vector<double> walled = walled_fractions(samples, neighbours.size());
  SmoothRegions regions = Division(part, neighbours, walled, kSmoothCosine).run();
  if (!is_mostly_its_own_partner(regions, samples)) return regions;
  SmoothRegions strict = Division(part, neighbours, walled, kStrictCosine).run();
  const bool is_better = !is_mostly_its_own_partner(strict, samples) && is_mostly_wide(part, neighbours, strict);
  return is_better ? strict : regions;
}

}  // namespace triskin::mesh
