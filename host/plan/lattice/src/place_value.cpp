// SPDX-License-Identifier: GPL-3.0-or-later
#include "place_value.hpp"

#include "triskin/base/index.hpp"

namespace triskin::lattice {
namespace {

constexpr double kMustCoverStep_mm = 4.0;

}  // namespace

CopiedRegions::CopiedRegions(const mesh::SurfaceRegions* regions, const CanonicalCopy& copy)
    : regions_(regions), copy_(copy) {
  if (regions_ == nullptr) return;
  for (const Vec3& p : regions_->free_points()) free_points_.push_back(copy_.to_copy(p));
  must_cover_ = regions_->must_cover(kMustCoverStep_mm);
  for (auto& place : must_cover_) place.point_mm = copy_.to_copy(place.point_mm);
}

bool PlaceValue::covered(const LatticeMesh& net, const mesh::SurfaceRegions::MustCover& place) {
  return net.any_near(place.point_mm, kModuleReach_mm + place.within_mm, [&](int t) {
    const NetTriangle& triangle = net.triangles()[at(t)];
    return mesh::distance_beside(triangle.rigid, triangle.corner_cut_mm, place.point_mm) <= place.within_mm;
  });
}

double PlaceValue::operator()(const LatticeMesh& net) {
  double module_value = net.size();
  if (regions_.has_weights()) {
    module_value = 0.0;
    if (known_.size() < net.triangles().size()) known_.resize(net.triangles().size());
    for (int t = 0; t < static_cast<int>(net.triangles().size()); ++t) {
      if (!net.used(t)) continue;
      Known& known = known_[at(t)];
      if (known.center != net.center(t)) known = {net.center(t), regions_.weight_at(net.center(t))};
      module_value += known.weight;
    }
  }
  for (const auto& place : regions_.must_cover()) {
    if (!covered(net, place)) module_value -= mesh::kUncoveredCost * place.share;
  }
  return module_value;
}

}  // namespace triskin::lattice
