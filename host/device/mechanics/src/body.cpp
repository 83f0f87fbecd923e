// SPDX-License-Identifier: GPL-3.0-or-later
#include "body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "triskin/base/error.hpp"

namespace triskin::mechanics {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void check_length(double value, const char* name) {
  if (!std::isfinite(value) || value <= 0.0)
    throw InputError(fmt::format("body: {} is {} mm; give a positive number", name, value));
}

double sphere_bottom(double radius, const Eigen::Vector2d& offset) {
  const double squared = radius * radius - offset.squaredNorm();
  return squared < 0.0 ? kInfinity : -std::sqrt(squared);
}

// Finds the lowest point of the spheres along a segment over one point. The height is convex along the segment, so an
// interval that always keeps the lower half finds it.
double capsule_bottom(double radius, const Eigen::Vector3d& first, const Eigen::Vector3d& second,
                      const Eigen::Vector2d& point) {
  const Eigen::Vector2d direction = (second - first).head<2>();
  const double length_squared = direction.squaredNorm();
  const double nearest =
      length_squared == 0.0 ? 0.0 : std::clamp((point - first.head<2>()).dot(direction) / length_squared, 0.0, 1.0);
  const auto height = [&](double share) {
    const Eigen::Vector3d centre = first + share * (second - first);
    return centre.z() + sphere_bottom(radius, point - centre.head<2>());
  };
  if (length_squared == 0.0) return std::min(height(0.0), height(1.0));
  if (height(nearest) == kInfinity) return kInfinity;
  double low = 0.0, high = 1.0;
  // Outside of the spheres that reach this point the height is infinite, so we first shrink towards the nearest centre.
  const double reach = std::sqrt(
      std::max(0.0, radius * radius - (point - (first + nearest * (second - first)).head<2>()).squaredNorm()) /
      length_squared);
  low = std::max(low, nearest - reach);
  high = std::min(high, nearest + reach);
  for (int step = 0; step < 60; ++step) {
    const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
    (height(a) < height(b) ? high : low) = height(a) < height(b) ? b : a;
  }
  return std::min(height((low + high) / 2.0), height(nearest));
}

struct Triangle {
  Eigen::Vector3d a, b, c;
};

double triangle_height(const Triangle& t, const Eigen::Vector2d& p) {
  const Eigen::Vector2d ab = (t.b - t.a).head<2>(), ac = (t.c - t.a).head<2>(), ap = p - t.a.head<2>();
  const double area = ab.x() * ac.y() - ab.y() * ac.x();
  if (area == 0.0) return kInfinity;
  const double v = (ap.x() * ac.y() - ap.y() * ac.x()) / area;
  const double w = (ab.x() * ap.y() - ab.y() * ap.x()) / area;
  // Points on an edge belong to both triangles, whatever rounding says.
  constexpr double kRounding = -1e-12;
  if (v < kRounding || w < kRounding || 1.0 - v - w < kRounding) return kInfinity;
  return t.a.z() + v * (t.b.z() - t.a.z()) + w * (t.c.z() - t.a.z());
}

std::vector<std::array<int, 3>> box_triangles() {
  // The bits of k give the signs of corner k; each side is two triangles.
  std::vector<std::array<int, 3>> triangles;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = 1 << ((axis + 1) % 3), v = 1 << ((axis + 2) % 3);
    for (const int side : {0, 1 << axis}) {
      triangles.push_back({side, side + u, side + u + v});
      triangles.push_back({side, side + u + v, side + v});
    }
  }
  return triangles;
}

}  // namespace

Body Body::sphere(double radius_mm) {
  check_length(radius_mm, "the radius");
  return Body([radius_mm](double x, double y) { return sphere_bottom(radius_mm, {x, y}); });
}

Body Body::capsule(double radius_mm, const Eigen::Vector3d& first, const Eigen::Vector3d& second) {
  check_length(radius_mm, "the radius");
  return Body([=](double x, double y) { return capsule_bottom(radius_mm, first, second, {x, y}); });
}

Body Body::box(const Eigen::Vector3d& size_mm, const Eigen::Matrix3d& rotation) {
  std::vector<Eigen::Vector3d> corners;
  for (int axis = 0; axis < 3; ++axis) check_length(size_mm[axis], "an edge");
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector3d signs((k & 1) != 0 ? 0.5 : -0.5, (k & 2) != 0 ? 0.5 : -0.5, (k & 4) != 0 ? 0.5 : -0.5);
    corners.emplace_back(rotation * signs.cwiseProduct(size_mm));
  }
  return mesh(std::move(corners), box_triangles());
}

Body Body::mesh(std::vector<Eigen::Vector3d> vertices, std::vector<std::array<int, 3>> triangles) {
  std::vector<Triangle> faces;
  for (const auto& t : triangles) {
    for (const int v : t) {
      if (v < 0 || static_cast<std::size_t>(v) >= vertices.size())
        throw InputError(fmt::format("body: a triangle names vertex {} of {}", v, vertices.size()));
    }
    const auto at = [&](int v) { return vertices[static_cast<std::size_t>(v)]; };
    faces.push_back({at(t[0]), at(t[1]), at(t[2])});
  }
  return Body([faces = std::move(faces)](double x, double y) {
    double lowest = kInfinity;
    for (const Triangle& face : faces) lowest = std::min(lowest, triangle_height(face, {x, y}));
    return lowest;
  });
}

}  // namespace triskin::mechanics
