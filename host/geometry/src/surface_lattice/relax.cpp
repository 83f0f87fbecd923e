// SPDX-License-Identifier: GPL-3.0-or-later
#include "relax.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "overlap.hpp"

namespace triskin::geometry::surface_lattice {
namespace {

constexpr double kDamping = 0.02;
constexpr int kLook = 3;
constexpr double kFarOff_mm = 2.2;
constexpr double kPair_mm = 38.0;        // centroids nearer than this may come to overlap while sliding
constexpr double kAllowedOverlap_mm = 0.1;
constexpr double kMoved_mm = 0.01;
constexpr double kNearBorder_mm = 12.0;
constexpr double kWantedGap_mm = 2.0;    // corners lift off where the centre would be deeper than this

}  // namespace

void Relaxer::relax(LatticeNet& net, int triangle, double radius_mm, int steps) {
  choose(net, net.triangles[at(triangle)].center, radius_mm);
  find_pairs(net);
  for (int k = 0; k < steps; ++k) {
    if (k == kLook && hopeless(net, triangle)) break;
    adapt_lift(net);
    if (step(net) < kMoved_mm) break;
  }
  settle(net);
}

// Most tried modules do not fit: what is still far off after a few steps is left to be refused.
bool Relaxer::hopeless(const LatticeNet& net, int triangle) const {
  const auto& v = net.triangles[at(triangle)].vertex;
  for (std::size_t s = 0; s < 3; ++s) {
    if (std::abs((net.vertices[at(v[s])].point - net.vertices[at(v[(s + 1) % 3])].point).norm() - kSide_mm) > kFarOff_mm) return true;
  }
  return std::ranges::any_of(pairs_, [&](const auto& pair) {
    return (pair[0] == triangle || pair[1] == triangle) &&
           overlap_of(net.triangles[at(pair[0])], net.triangles[at(pair[1])]).depth_mm > kFarOff_mm;
  });
}

void Relaxer::choose(const LatticeNet& net, const Vec3& place, double radius_mm) {
  local_.assign(net.vertices.size(), -1);
  moving_.clear();
  triangles_.clear();
  saved_.clear();
  for (int v = 0; v < static_cast<int>(net.vertices.size()); ++v) {
    const NetVertex& w = net.vertices[at(v)];
    if (!w.used || (w.point - place).squaredNorm() > radius_mm * radius_mm) continue;
    local_[at(v)] = static_cast<int>(moving_.size());
    moving_.push_back(v);
    saved_.push_back(w);
  }
  for (int t = 0; t < static_cast<int>(net.triangles.size()); ++t) {
    const auto& v = net.triangles[at(t)].vertex;
    if (net.used(t) && (local_[at(v[0])] >= 0 || local_[at(v[1])] >= 0 || local_[at(v[2])] >= 0)) triangles_.push_back(t);
  }
}

void Relaxer::find_pairs(const LatticeNet& net) {
  pairs_.clear();
  for (const int a : triangles_) {
    for (int b = 0; b < static_cast<int>(net.triangles.size()); ++b) {
      if (!net.used(b) || b == a) continue;
      if (b < a && std::ranges::binary_search(triangles_, b)) continue;  // found from its own side
      const NetTriangle &p = net.triangles[at(a)], &q = net.triangles[at(b)];
      if ((p.center - q.center).squaredNorm() < kPair_mm * kPair_mm && !net.joined(a, b)) pairs_.push_back({a, b});
    }
  }
}

void Relaxer::add_residual(double value, double weight, const std::array<int, 2>& vertex, const std::array<Vec3, 2>& gradient) {
  std::array<int, 2> base{-1, -1};
  std::array<Eigen::Vector2d, 2> g;
  for (std::size_t k = 0; k < 2; ++k) {
    const int local = vertex[k] < 0 ? -1 : local_[at(vertex[k])];
    if (local < 0) continue;
    base[k] = 2 * local;
    g[k] = {gradient[k].dot(frames_[at(local)].x), gradient[k].dot(frames_[at(local)].y)};
  }
  for (std::size_t p = 0; p < 2; ++p) {
    if (base[p] < 0) continue;
    right_.segment<2>(base[p]) -= weight * value * g[p];
    for (std::size_t q = 0; q < 2; ++q) {
      if (base[q] >= 0) matrix_.block<2, 2>(base[p], base[q]) += weight * g[p] * g[q].transpose();
    }
  }
}

// Long and short edges weigh more, so that the largest error falls; a module is easier to part than to push together.
void Relaxer::add_edges(const LatticeNet& net) {
  for (const int t : triangles_) {
    const auto& v = net.triangles[at(t)].vertex;
    for (std::size_t s = 0; s < 3; ++s) {
      const int a = v[s], b = v[(s + 1) % 3];
      const Vec3 d = net.vertices[at(a)].point - net.vertices[at(b)].point;
      const double length = d.norm(), error = length - kSide_mm;
      const double weight = (0.15 + error * error) * (error < 0 ? 1.5 : 1.0);
      add_residual(error, std::min(weight, 4.0), {a, b}, {Vec3(d / length), Vec3(-d / length)});
    }
  }
}

void Relaxer::add_pairs(const LatticeNet& net) {
  for (const auto& [a, b] : pairs_) {
    const NetTriangle &p = net.triangles[at(a)], &q = net.triangles[at(b)];
    const Overlap o = overlap_of(p, q);
    if (o.depth_mm <= kAllowedOverlap_mm) continue;
    // The whole module gives way, the touching corner most.
    const int va = p.vertex[at(o.corner_a)], vb = q.vertex[at(o.corner_b)];
    add_residual(o.depth_mm - kAllowedOverlap_mm, 3.0, {va, vb}, {o.axis, Vec3(-o.axis)});
  }
}

// Sides of modules near the border: what stands over it is pushed back through the corners of the side.
void Relaxer::add_border(const LatticeNet& net) {
  for (std::size_t k = 0; k < moving_.size(); ++k) {
    const NetVertex& v = net.vertices[at(moving_[k])];
    if (v.on_border) add_residual(0.0, 6.0, {moving_[k], -1}, {v.outward, Vec3::Zero()});
  }
  for (const int t : triangles_) {
    const NetTriangle& triangle = net.triangles[at(t)];
    for (std::size_t s = 0; s < 3; ++s) {
      if (net.neighbour(t, static_cast<int>(s)) >= 0) continue;
      const Vec3 &a = triangle.rigid[s], &b = triangle.rigid[(s + 1) % 3];
      if (surface_.border_distance(0.5 * (a + b)) > kNearBorder_mm + 0.5 * kSide_mm) continue;
      for (const double x : {0.0, 0.2, 0.4, 0.6, 0.8}) {
        const Vec3 p = a + x * (b - a);
        if (surface_.border_distance(p) > kNearBorder_mm) continue;
        const SurfacePoint c = surface_.closest(p);
        const Vec3 n = surface_.normal_at(c), off = p - c.position_mm, over = off - off.dot(n) * n;
        const double depth = over.norm();
        if (depth < 0.15 || depth > 10.0 || surface_.border_distance(c.position_mm) > 1e-6) continue;
        const Vec3 out = over / depth;
        add_residual(depth - 0.15, 2.0, {triangle.vertex[s], triangle.vertex[(s + 1) % 3]}, {Vec3((1 - x) * out), Vec3(x * out)});
      }
    }
  }
}

double Relaxer::step(LatticeNet& net) {
  const auto size = static_cast<Eigen::Index>(2 * moving_.size());
  matrix_.setZero(size, size);
  matrix_.diagonal().setConstant(kDamping);
  right_.setZero(size);
  frames_.resize(moving_.size());
  for (std::size_t k = 0; k < moving_.size(); ++k) {
    frames_[k].x = net.vertices[at(moving_[k])].normal.unitOrthogonal();
    frames_[k].y = net.vertices[at(moving_[k])].normal.cross(frames_[k].x);
  }
  add_edges(net);
  add_pairs(net);
  add_border(net);
  const Eigen::VectorXd solution = matrix_.ldlt().solve(right_);
  double largest = 0.0;
  for (int k = 0; k < static_cast<int>(moving_.size()); ++k) {
    Vec3 by = solution[2 * k] * frames_[at(k)].x + solution[2 * k + 1] * frames_[at(k)].y;
    const double length = by.norm();
    if (!(length < 1e3)) by.setZero();
    if (length > 5.0) by *= 5.0 / length;
    largest = std::max(largest, std::min(length, 5.0));
    move(net, k, by);
  }
  for (const int t : triangles_) net.fit(t);
  return largest;
}

void Relaxer::move(LatticeNet& net, int local, const Vec3& by) const {
  NetVertex& v = net.vertices[at(moving_[at(local)])];
  const Vec3 wanted = v.point - v.lift_mm * v.normal + by;
  const SurfacePoint c = surface_.closest(wanted);
  v.normal = surface_.normal_at(c);
  v.point = c.position_mm + v.lift_mm * v.normal;
  const Vec3 off = wanted - c.position_mm, over = off - off.dot(v.normal) * v.normal;
  v.on_border = over.norm() > 1e-3 && surface_.border_distance(c.position_mm) < 1e-6;
  if (v.on_border) v.outward = over.normalized();
}

// Modules that bridge a strong convex bend dip under it at the centre: their corners stand off a little.
void Relaxer::adapt_lift(LatticeNet& net) {
  if (lift_mm_ <= 0.0) return;
  for (std::size_t k = 0; k < moving_.size(); ++k) {
    NetVertex& v = net.vertices[at(moving_[k])];
    v.point -= v.lift_mm * v.normal;
    v.lift_mm = std::max(0.0, v.lift_mm - 0.1);
  }
  for (const int t : triangles_) {
    const NetTriangle& triangle = net.triangles[at(t)];
    const SurfacePoint c = surface_.closest(triangle.center);
    const double under = (c.position_mm - triangle.center).dot(triangle.normal);
    if (under < kWantedGap_mm) continue;
    for (const int v : triangle.vertex) {
      if (local_[at(v)] < 0) continue;
      double& lift = net.vertices[at(v)].lift_mm;
      lift = std::min(lift_mm_, lift + 0.5 * (under - kWantedGap_mm));
    }
  }
  for (const int v : moving_) net.vertices[at(v)].point += net.vertices[at(v)].lift_mm * net.vertices[at(v)].normal;
  for (const int t : triangles_) net.fit(t);
}

// Corners that hardly moved go back, so that their modules need no new judgement.
void Relaxer::settle(LatticeNet& net) {
  std::vector<bool> moved(moving_.size(), false);
  for (std::size_t k = 0; k < moving_.size(); ++k) {
    NetVertex& v = net.vertices[at(moving_[k])];
    moved[k] = (v.point - saved_[k].point).norm() > kMoved_mm;
    if (!moved[k]) {
      v.point = saved_[k].point;
      v.normal = saved_[k].normal;
      v.lift_mm = saved_[k].lift_mm;
    }
  }
  changed_.clear();
  for (const int t : triangles_) {
    net.fit(t);
    const auto has_moved = [&](int v) { return local_[at(v)] >= 0 && moved[at(local_[at(v)])]; };
    if (std::ranges::any_of(net.triangles[at(t)].vertex, has_moved)) changed_.push_back(t);
  }
}

void Relaxer::undo(LatticeNet& net) const {
  for (std::size_t k = 0; k < moving_.size(); ++k) {
    NetVertex& v = net.vertices[at(moving_[k])];
    v.point = saved_[k].point;
    v.normal = saved_[k].normal;
    v.lift_mm = saved_[k].lift_mm;
  }
  for (const int t : triangles_) net.fit(t);
}

}  // namespace triskin::geometry::surface_lattice
