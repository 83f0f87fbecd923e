// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernels/edge_grid.hpp"

#include <algorithm>

#include "triskin/geometry/segment.hpp"

namespace triskin::placement {
namespace {

constexpr double kMinBucket_mm = 8.0;
constexpr int kMaxBuckets = 512;

// Adds the edges that come within reach of a point of the polygon's frame.
void add_pairs(const PreparedPolygon& polygon, const EdgeGrid& edges, const Vec2& p, double reach_mm,
               std::uint32_t tile, std::vector<Pair>& pairs) {
  if (reach_mm > edges.reach_mm()) {
    for (std::uint32_t edge = 0; edge < polygon.x.size(); ++edge) pairs.push_back({tile, edge});
    return;
  }
  const double far = (reach_mm + 1e-6) * (reach_mm + 1e-6);
  for (const std::uint32_t edge : edges.near(p)) {
    const auto& [a, b] = polygon.edges[edge];
    const double dx = b.x() - a.x(), dy = b.y() - a.y(), qx = p.x() - a.x(), qy = p.y() - a.y();
    const double square = dx * dx + dy * dy, along = qx * dx + qy * dy, across = qx * dy - qy * dx;
    const double end_x = p.x() - b.x(), end_y = p.y() - b.y();
    const bool near = along <= 0.0      ? qx * qx + qy * qy <= far
                      : along >= square ? end_x * end_x + end_y * end_y <= far
                                        : across * across <= far * square;
    if (near) pairs.push_back({tile, edge});
  }
}

}  // namespace

EdgeGrid::EdgeGrid(const PreparedPolygon& polygon, double reach_mm) : reach_mm_(reach_mm) {
  const double extent = polygon.radius_mm + reach_mm;
  const double size = std::max(kMinBucket_mm, 2.0 * extent / kMaxBuckets), far = reach_mm + 0.75 * size;
  origin_ = -extent;
  scale_ = 1.0 / size;
  buckets_ = static_cast<int>(std::ceil(2.0 * extent * scale_)) + 1;
  const auto index = [&](double v) { return std::clamp(static_cast<int>((v - origin_) * scale_), 0, buckets_ - 1); };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
  for (std::uint32_t k = 0; k < polygon.edges.size(); ++k) {
    const auto& [a, b] = polygon.edges[k];
    const Vec2 low = a.cwiseMin(b) - Vec2::Constant(far), high = a.cwiseMax(b) + Vec2::Constant(far);
    for (int j = index(low.y()); j <= index(high.y()); ++j) {
      for (int i = index(low.x()); i <= index(high.x()); ++i) {
        const Vec2 p(origin_ + (i + 0.5) * size, origin_ + (j + 0.5) * size);
        if (geometry::distance_to_segment(p, a, b) <= far)
          found.emplace_back(static_cast<std::uint32_t>(j * buckets_ + i), k);
      }
    }
  }
  first_.assign(static_cast<std::size_t>(buckets_) * static_cast<std::size_t>(buckets_) + 1, 0);
  for (const auto& [bucket, edge] : found) ++first_[bucket + 1];
  for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
  edges_.resize(found.size());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (const auto& [bucket, edge] : found) edges_[next[bucket]++] = edge;
}

std::span<const std::uint32_t> EdgeGrid::near(const Vec2& p) const {
  const int i = static_cast<int>(std::floor((p.x() - origin_) * scale_)),
            j = static_cast<int>(std::floor((p.y() - origin_) * scale_));
  if (i < 0 || j < 0 || i >= buckets_ || j >= buckets_) return {};
  const auto bucket = static_cast<std::size_t>(j * buckets_ + i);
  return {edges_.data() + first_[bucket], first_[bucket + 1] - first_[bucket]};
}

void list_with_edges(const PreparedPolygon& polygon, const EdgeGrid& edges, const MotionBox& box, double reach_mm,
                     const CellList& from, CellList& to) {
  to.clear();
  const Vec2 shift(box.center(0), box.center(1));
  const double c = std::cos(box.center(2)), s = std::sin(box.center(2));
  for (OpenTile tile : from.tiles) {
    const Vec2 p = tile.center - shift;
    tile.first = static_cast<std::uint32_t>(to.pairs.size());
    add_pairs(polygon, edges, {c * p.x() + s * p.y(), -s * p.x() + c * p.y()}, reach_mm,
              static_cast<std::uint32_t>(to.tiles.size()), to.pairs);
    tile.count = static_cast<std::uint32_t>(to.pairs.size()) - tile.first;
    to.tiles.push_back(tile);
  }
}

}  // namespace triskin::placement
