// SPDX-License-Identifier: GPL-3.0-or-later
#include "outside_view.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "triskin/base/index.hpp"

namespace triskin::mesh {
namespace {

constexpr int kHullDirections = 1500;
constexpr double kGoldenAngle = 2.399963229728653;
constexpr double kAbove_mm = 0.05;
constexpr double kFar_mm = 1e6;  // A part is at most 5 m across.

// A Fibonacci spiral spreads the directions evenly over the sphere.
const std::vector<Vec3>& hull_directions() {
  static const std::vector<Vec3> directions = [] {
    std::vector<Vec3> result;
    for (int k = 0; k < kHullDirections; ++k) {
      const double z = 1.0 - (2.0 * k + 1.0) / kHullDirections, r = std::sqrt(1.0 - z * z);
      result.emplace_back(r * std::cos(kGoldenAngle * k), r * std::sin(kGoldenAngle * k), z);
    }
    return result;
  }();
  return directions;
}

}  // namespace

HullDepth::HullDepth(const std::vector<Vec3>& points_mm) {
  std::vector<std::size_t> extremes;
  for (const Vec3& direction : hull_directions()) {
    double highest = -std::numeric_limits<double>::infinity();
    std::size_t which = 0;
    for (std::size_t k = 0; k < points_mm.size(); ++k) {
      const double height = direction.dot(points_mm[k]);
      if (height <= highest) continue;
      highest = height;
      which = k;
    }
    heights_mm_.push_back(highest);
    extremes.push_back(which);
  }
  std::ranges::sort(extremes);
  extremes.erase(std::unique(extremes.begin(), extremes.end()), extremes.end());
  for (const std::size_t k : extremes) extremes_mm_.push_back(points_mm[k]);
}

// The half space of the normal itself is exact on flat surfaces; those of other directions are not.
double HullDepth::along(const Vec3& point_mm, const Vec3& normal) const {
  double depth = 0.0;
  for (const Vec3& p : extremes_mm_) depth = std::max(depth, normal.dot(p - point_mm));
  const std::vector<Vec3>& directions = hull_directions();
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const double slope = directions[k].dot(normal);
    if (slope > 0.0) depth = std::min(depth, std::max(0.0, heights_mm_[k] - directions[k].dot(point_mm)) / slope);
  }
  return depth;
}

bool HullDepth::encloses(const HullDepth& other, double by_mm) const {
  return std::ranges::equal(heights_mm_, other.heights_mm_, [by_mm](double a, double b) { return a > b + by_mm; });
}

double HullDepth::mean_height_mm() const {
  return std::reduce(heights_mm_.begin(), heights_mm_.end()) / static_cast<double>(heights_mm_.size());
}

double visibility_of(const RayCaster& part, const Vec3& point_mm, const Vec3& normal, int rays, unsigned turn) {
  const Vec3 x = normal.unitOrthogonal(), y = normal.cross(x), start = point_mm + kAbove_mm * normal;
  const double first = 2.0 * std::numbers::pi * std::fmod(0.6180339887498949 * turn, 1.0);
  int free = 0;
  // Even points of the disc, raised to the half sphere, are weighted by the cosine (Malley).
  for (int k = 0; k < rays; ++k) {
    const double squared = (k + 0.5) / rays, r = std::sqrt(squared), angle = first + kGoldenAngle * k;
    const Vec3 ray = r * std::cos(angle) * x + r * std::sin(angle) * y + std::sqrt(1.0 - squared) * normal;
    free += part.is_free(start, ray, kFar_mm) ? 1 : 0;
  }
  return static_cast<double>(free) / rays;
}

}  // namespace triskin::mesh
