// SPDX-License-Identifier: GPL-3.0-or-later
#include "canonical.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "triskin/base/index.hpp"
#include "triskin/design/mirror.hpp"

namespace triskin::lattice {
namespace {

constexpr double kGridsAMm = 256.0;

struct Face {
  Vec3 a, b, c;
  [[nodiscard]] double area() const { return 0.5 * (b - a).cross(c - a).norm(); }
};

Face face_of(const Mesh& m, const std::array<int, 3>& f) {
  return {m.vertices[at(f[0])], m.vertices[at(f[1])], m.vertices[at(f[2])]};
}

// The mean of x³ over a triangle is the mean of the ten products of three of its corners' x.
double mean_cube(double a, double b, double c) {
  return (a * a * a + b * b * b + c * c * c + a * a * b + a * a * c + b * b * a + b * b * c + c * c * a + c * c * b +
          a * b * c) /
         10.0;
}

bool keeps_faces(const Mesh& before, const Mesh& after) {
  for (std::size_t f = 0; f < before.faces.size(); ++f) {
    if (face_of(after, before.faces[f]).area() < 0.5 * face_of(before, before.faces[f]).area()) return false;
  }
  return true;
}

}  // namespace

CanonicalCopy::CanonicalCopy(const Mesh& original) {
  choose_axes(original);
  move_and_sort(original, true);
}

// Uses moments of the area, not of the vertices, because they do not depend on how a shape is meshed.
void CanonicalCopy::choose_axes(const Mesh& original) {
  if (original.vertices.empty()) return;
  const Vec3 from = original.vertices.front();  // Sums of places far from the origin would lose digits.
  double area = 0.0;
  Vec3 moment = Vec3::Zero();
  for (const auto& f : original.faces) {
    const Face t = face_of(original, f);
    moment += t.area() * ((t.a - from) + (t.b - from) + (t.c - from)) / 3.0;
    area += t.area();
  }
  if (!(area > 0.0)) return;
  middle_ = from + moment / area;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& f : original.faces) {
    const Face t = face_of(original, f);
    const Vec3 a = t.a - middle_, b = t.b - middle_, c = t.c - middle_, s = a + b + c;
    spread += t.area() * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  for (int k = 0; k < 3; ++k) {
    Vec3& axis = axis_[at(k)] = axes.eigenvectors().col(2 - k);
    double lean = 0.0;  // The heavier tail shows the direction.
    for (const auto& f : original.faces) {
      const Face t = face_of(original, f);
      lean += t.area() * mean_cube(axis.dot(t.a - middle_), axis.dot(t.b - middle_), axis.dot(t.c - middle_));
    }
    if (lean < 0.0) axis = -axis;
  }
  mirrored_ = axis_[0].cross(axis_[1]).dot(axis_[2]) < 0.0;
}

void CanonicalCopy::move_and_sort(const Mesh& original, bool on_grid) {
  Mesh moved{original.vertices, original.faces};
  for (Vec3& v : moved.vertices) {
    const Vec3 d = v - middle_;
    v = {axis_[0].dot(d), axis_[1].dot(d), axis_[2].dot(d)};
    if (on_grid) v = (v * kGridsAMm).array().round() / kGridsAMm;
  }
  if (on_grid && !keeps_faces(original, moved)) return move_and_sort(original, false);
  std::vector<int> order(moved.vertices.size()), place(moved.vertices.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<int>(k);
  std::ranges::sort(order, [&](int a, int b) {
    const Vec3 &p = moved.vertices[at(a)], &q = moved.vertices[at(b)];
    return std::array{p.x(), p.y(), p.z()} < std::array{q.x(), q.y(), q.z()};
  });
  for (std::size_t k = 0; k < order.size(); ++k) {
    place[at(order[k])] = static_cast<int>(k);
    mesh_.vertices.push_back(moved.vertices[at(order[k])]);
  }
  for (const auto& f : moved.faces) {
    std::array<int, 3> g{place[at(f[0])], place[at(f[1])], place[at(f[2])]};
    if (mirrored_) std::swap(g[1], g[2]);
    std::ranges::rotate(g, std::ranges::min_element(g));
    mesh_.faces.push_back(g);
  }
  std::ranges::sort(mesh_.faces);
}

void CanonicalCopy::carry_back(ModuleLayout& layout) const {
  for (PlacedModule& m : layout.modules) {
    for (Vec3& c : m.corner_mm) c = to_original(c);
    if (mirrored_) m = design::in_mirrored_lattice(m);
  }
}

PlacedModule CanonicalCopy::carried_there(PlacedModule m) const {
  for (Vec3& c : m.corner_mm) c = to_copy(c);
  return mirrored_ ? design::in_mirrored_lattice(m) : m;
}

}  // namespace triskin::lattice
