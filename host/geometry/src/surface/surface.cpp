// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/geometry/surface.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "index.hpp"
#include "triskin/host/error.hpp"

namespace triskin::geometry {
namespace {

inline double box_distance_squared(const Eigen::Array3d& low, const Eigen::Array3d& high, const Vec3& q) {
  const double x = std::max(std::max(low[0] - q[0], q[0] - high[0]), 0.0);
  const double y = std::max(std::max(low[1] - q[1], q[1] - high[1]), 0.0);
  const double z = std::max(std::max(low[2] - q[2], q[2] - high[2]), 0.0);
  return x * x + y * y + z * z;
}

// 0: at a … 1: at b.
double closest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  const double length_squared = d.squaredNorm();
  return length_squared > 0.0 ? std::clamp((p - a).dot(d) / length_squared, 0.0, 1.0) : 0.0;
}

}  // namespace

// Regions of Voronoi of the triangle's features (Ericson, Real-Time Collision Detection, 5.1.5).
Vec3 closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {1, 0, 0};
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    const double v = d1 / (d1 - d3);
    return {1 - v, v, 0};
  }
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    const double w = d2 / (d2 - d6);
    return {1 - w, 0, w};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && (d4 - d3) >= 0.0 && (d5 - d6) >= 0.0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

Surface::Surface(Mesh mesh) : mesh_(std::move(mesh)) {
  connect_faces();
  compute_normals();
  find_loops();
  build_trees();
}

void Surface::connect_faces() {
  struct Side {
    int face, side;
  };
  std::map<std::pair<int, int>, Side> open;  // directed edge → its only face
  neighbour_.assign(mesh_.faces.size(), {-1, -1, -1});
  for (std::size_t f = 0; f < mesh_.faces.size(); ++f) {
    for (int s = 0; s < 3; ++s) {
      const std::pair edge{mesh_.faces[f][at(s)], mesh_.faces[f][at((s + 1) % 3)]};
      if (!open.try_emplace(edge, Side{static_cast<int>(f), s}).second) {
        throw InputError(
            fmt::format("surface: the edge from vertex {} to {} has more than two faces or faces of opposite "
                        "orientation (face {}); run `triskin extract` first",
                        edge.first, edge.second, f));
      }
    }
  }
  for (const auto& [edge, side] : open) {
    const auto twin = open.find({edge.second, edge.first});
    if (twin != open.end()) neighbour_[at(side.face)][at(side.side)] = twin->second.face;
  }
}

void Surface::compute_normals() {
  vertex_normal_.assign(mesh_.vertices.size(), Vec3::Zero());
  face_normal_.reserve(mesh_.faces.size());
  for (const auto& f : mesh_.faces) {
    const std::array p{mesh_.vertices[at(f[0])], mesh_.vertices[at(f[1])], mesh_.vertices[at(f[2])]};
    const Vec3 n = (p[1] - p[0]).cross(p[2] - p[0]);
    area_mm2_ += 0.5 * n.norm();
    face_normal_.push_back(n.normalized());
    for (int k = 0; k < 3; ++k) {
      const Vec3 u = (p[at((k + 1) % 3)] - p[at(k)]).normalized(), v = (p[at((k + 2) % 3)] - p[at(k)]).normalized();
      vertex_normal_[at(f[at(k)])] += std::acos(std::clamp(u.dot(v), -1.0, 1.0)) * face_normal_.back();
    }
  }
  for (Vec3& n : vertex_normal_) {
    if (n.norm() > 0.0) n.normalize();
  }
}

void Surface::find_loops() {
  std::multimap<int, int> next;  // border edges; a pinched vertex has several
  for (std::size_t f = 0; f < mesh_.faces.size(); ++f) {
    for (int s = 0; s < 3; ++s) {
      if (neighbour_[f][at(s)] >= 0) continue;
      const std::array edge{mesh_.faces[f][at(s)], mesh_.faces[f][at((s + 1) % 3)]};
      border_sides_.push_back({static_cast<int>(f), s});
      next.emplace(edge[0], edge[1]);
    }
  }
  while (!next.empty()) {
    std::vector<int> loop;
    auto edge = next.begin();
    const int start = edge->first;
    while (edge != next.end()) {
      loop.push_back(edge->first);
      const int to = edge->second;
      next.erase(edge);
      if (to == start) break;
      edge = next.find(to);
    }
    loops_.push_back(std::move(loop));
  }
}

Surface::Tree Surface::build_tree(const std::vector<std::array<Eigen::Array3d, 2>>& extents) {
  constexpr int kLeafSize = 4;
  Tree tree;
  tree.items.resize(extents.size());
  std::iota(tree.items.begin(), tree.items.end(), 0);
  if (extents.empty()) return tree;
  tree.boxes.push_back({.first = 0, .count = static_cast<int>(extents.size())});
  for (std::size_t n = 0; n < tree.boxes.size(); ++n) {  // boxes appended while walking: breadth first
    const int first = tree.boxes[n].first, count = tree.boxes[n].count;
    Eigen::Array3d low = extents[at(tree.items[at(first)])][0], high = extents[at(tree.items[at(first)])][1];
    for (int k = first; k < first + count; ++k) {
      low = low.min(extents[at(tree.items[at(k)])][0]);
      high = high.max(extents[at(tree.items[at(k)])][1]);
    }
    tree.boxes[n].low = low;
    tree.boxes[n].high = high;
    if (count <= kLeafSize) continue;
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const auto middle_of = [&](int item) { return extents[at(item)][0][axis] + extents[at(item)][1][axis]; };
    const auto begin = tree.items.begin() + first;
    std::nth_element(begin, begin + count / 2, begin + count,
                     [&](int a, int b) { return std::pair(middle_of(a), a) < std::pair(middle_of(b), b); });
    tree.boxes[n].left = static_cast<int>(tree.boxes.size());
    tree.boxes[n].right = tree.boxes[n].left + 1;
    tree.boxes[n].count = 0;
    tree.boxes.push_back({.first = first, .count = count / 2});
    tree.boxes.push_back({.first = first + count / 2, .count = count - count / 2});
  }
  return tree;
}

template <class Visit>
void Surface::nearest(const Tree& tree, const Vec3& query, double& best_squared, Visit visit) {
  if (tree.boxes.empty()) return;
  std::array<int, 128> stack;  // depth of a median split of 2^31 items is under 64
  int top = 0;
  stack[0] = 0;
  while (top >= 0) {
    const Box& box = tree.boxes[at(stack[at(top--)])];
    if (box_distance_squared(box.low, box.high, query) >= best_squared) continue;
    for (int k = box.first; k < box.first + box.count; ++k) visit(tree.items[at(k)]);
    if (box.left < 0) continue;
    const auto distance = [&](int n) {
      return box_distance_squared(tree.boxes[at(n)].low, tree.boxes[at(n)].high, query);
    };
    const bool left_first = distance(box.left) <= distance(box.right);
    stack[at(++top)] = left_first ? box.right : box.left;
    stack[at(++top)] = left_first ? box.left : box.right;
  }
}

void Surface::build_trees() {
  std::vector<std::array<Eigen::Array3d, 2>> extents;
  for (const auto& f : mesh_.faces) {
    const auto a = mesh_.vertices[at(f[0])].array(), b = mesh_.vertices[at(f[1])].array(),
               c = mesh_.vertices[at(f[2])].array();
    extents.push_back({Eigen::Array3d(a.min(b).min(c)), Eigen::Array3d(a.max(b).max(c))});
  }
  face_tree_ = build_tree(extents);
  extents.clear();
  for (const auto& [face, side] : border_sides_) {
    const auto& f = mesh_.faces[at(face)];
    const auto a = mesh_.vertices[at(f[at(side)])].array(), b = mesh_.vertices[at(f[at((side + 1) % 3)])].array();
    extents.push_back({Eigen::Array3d(a.min(b)), Eigen::Array3d(a.max(b))});
  }
  border_tree_ = build_tree(extents);
}

SurfacePoint Surface::closest(const Vec3& query_mm) const {
  SurfacePoint best;
  double best_squared = std::numeric_limits<double>::infinity();
  nearest(face_tree_, query_mm, best_squared, [&](int face) {
    const auto& f = mesh_.faces[at(face)];
    const Vec3 &a = mesh_.vertices[at(f[0])], &b = mesh_.vertices[at(f[1])], &c = mesh_.vertices[at(f[2])];
    const Vec3 weights = closest_on_triangle(query_mm, a, b, c);
    const Vec3 p = weights[0] * a + weights[1] * b + weights[2] * c;
    const double squared = (p - query_mm).squaredNorm();
    if (squared < best_squared) {
      best_squared = squared;
      best = {p, face, weights, 0.0};
    }
  });
  best.distance_mm = std::sqrt(best_squared);
  return best;
}

void Surface::faces_within(const Vec3& query_mm, double distance_mm, std::vector<std::pair<double, int>>& faces) const {
  double limit = std::nextafter(distance_mm * distance_mm, std::numeric_limits<double>::infinity());
  nearest(face_tree_, query_mm, limit, [&](int face) {
    const auto& f = mesh_.faces[at(face)];
    const Vec3 &a = mesh_.vertices[at(f[0])], &b = mesh_.vertices[at(f[1])], &c = mesh_.vertices[at(f[2])];
    const Vec3 weights = closest_on_triangle(query_mm, a, b, c);
    const double squared = (weights[0] * a + weights[1] * b + weights[2] * c - query_mm).squaredNorm();
    if (squared < limit) faces.emplace_back(squared, face);
  });
}

BorderPoint Surface::closest_on_edge(int item, const Vec3& query_mm) const {
  const auto [face, side] = border_sides_[at(item)];
  const auto& f = mesh_.faces[at(face)];
  const Vec3 &a = mesh_.vertices[at(f[at(side)])], &b = mesh_.vertices[at(f[at((side + 1) % 3)])];
  const double t = closest_on_segment(query_mm, a, b);
  BorderPoint closest{{a + t * (b - a), face, Vec3::Zero(), 0.0}, side};
  closest.point.barycentric[side] = 1.0 - t;
  closest.point.barycentric[(side + 1) % 3] = t;
  return closest;
}

SurfacePoint Surface::closest_on_border(const Vec3& query_mm) const {
  SurfacePoint best;
  double best_squared = std::numeric_limits<double>::infinity();
  nearest(border_tree_, query_mm, best_squared, [&](int item) {
    const BorderPoint closest = closest_on_edge(item, query_mm);
    const double squared = (closest.point.position_mm - query_mm).squaredNorm();
    if (squared >= best_squared) return;
    best_squared = squared;
    best = closest.point;
  });
  best.distance_mm = std::sqrt(best_squared);
  return best;
}

void Surface::border_within(const Vec3& query_mm, double distance_mm, std::vector<BorderPoint>& points) const {
  double limit = std::nextafter(distance_mm * distance_mm, std::numeric_limits<double>::infinity());
  nearest(border_tree_, query_mm, limit, [&](int item) {
    BorderPoint closest = closest_on_edge(item, query_mm);
    const double squared = (closest.point.position_mm - query_mm).squaredNorm();
    if (squared >= limit) return;
    closest.point.distance_mm = std::sqrt(squared);
    points.push_back(closest);
  });
}

double Surface::border_distance(const Vec3& query_mm) const {
  return closest_on_border(query_mm).distance_mm;
}

Vec3 Surface::normal_at(const SurfacePoint& point) const {
  const auto& f = mesh_.faces[at(point.face)];
  const Vec3 n = point.barycentric[0] * vertex_normal_[at(f[0])] + point.barycentric[1] * vertex_normal_[at(f[1])] +
                 point.barycentric[2] * vertex_normal_[at(f[2])];
  return n.norm() > 1e-9 ? Vec3(n.normalized()) : face_normal_[at(point.face)];
}

}  // namespace triskin::geometry
