// SPDX-License-Identifier: GPL-3.0-or-later
#include "flatten.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "triskin/base/index.hpp"
#include "triskin/design/design_types.hpp"

namespace triskin::unfolding {
namespace {

const Vec3& corner(const mesh::Surface& s, FaceIndex face, int k) {
  return s.mesh().vertices[at(s.mesh().faces[at(face)][at(k)])];
}

// Returns the triangle in its own plane: corner 0 at the origin, corner 1 on the x axis.
std::array<Vec2, 3> own_plane(const mesh::Surface& s, FaceIndex face) {
  const Vec3 e1 = corner(s, face, 1) - corner(s, face, 0), e2 = corner(s, face, 2) - corner(s, face, 0);
  const double length = e1.norm(), along = e2.dot(e1) / length;
  return {Vec2(0, 0), Vec2(length, 0), Vec2(along, e1.cross(e2).norm() / length)};
}

// Makes local vertices and splits a vertex whose faces in the chart are joined only by that point.
FlatChart make_chart(const CutSurface& cut, const std::vector<FaceIndex>& faces) {
  const mesh::Surface& s = cut.surface();
  FlatChart c;
  c.faces = faces;
  c.local_faces.assign(faces.size(), {-1, -1, -1});
  std::map<FaceIndex, std::size_t> local_of;
  for (std::size_t k = 0; k < faces.size(); ++k) local_of[faces[k]] = k;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    for (int v = 0; v < 3; ++v) {
      if (c.local_faces[k][at(v)] >= 0) continue;
      const int id = static_cast<int>(c.vertices.size());
      const VertexIndex vertex(s.mesh().faces[at(faces[k])][at(v)]);
      c.vertices.push_back(vertex);
      std::vector<FaceIndex> fan{faces[k]};  // These faces around the vertex are connected by edges.
      std::set<FaceIndex> seen{faces[k]};
      for (std::size_t f = 0; f < fan.size(); ++f) {
        const auto& corners = s.mesh().faces[at(fan[f])];
        for (int side = 0; side < 3; ++side) {
          if (corners[at(side)] == vertex) c.local_faces[local_of.at(fan[f])][at(side)] = id;
          const bool touches = corners[at(side)] == vertex || corners[at((side + 1) % 3)] == vertex;
          const FaceIndex next = cut.neighbour(fan[f], side);
          if (touches && next >= 0 && local_of.contains(next) && seen.insert(next).second) fan.push_back(next);
        }
      }
    }
  }
  c.flat.assign(c.vertices.size(), Vec2::Zero());
  return c;
}

int middle_face(const mesh::Surface& s, const std::vector<FaceIndex>& faces) {
  Vec3 center = Vec3::Zero();
  const auto middle = [&](FaceIndex f) -> Vec3 { return (corner(s, f, 0) + corner(s, f, 1) + corner(s, f, 2)) / 3.0; };
  for (const FaceIndex f : faces) center += middle(f) / static_cast<double>(faces.size());
  return static_cast<int>(
      std::ranges::min_element(faces, {}, [&](FaceIndex f) { return (middle(f) - center).squaredNorm(); }) -
      faces.begin());
}

// Unfolds breadth first across edges; a vertex keeps its first place.
void unfold_start(const CutSurface& cut, FlatChart& c) {
  const mesh::Surface& s = cut.surface();
  std::map<FaceIndex, int> local_of;
  for (std::size_t k = 0; k < c.faces.size(); ++k) local_of[c.faces[k]] = static_cast<int>(k);
  std::vector<bool> placed(c.vertices.size(), false), done(c.faces.size(), false);
  std::vector<int> queue{middle_face(s, c.faces)};
  done[at(queue[0])] = true;
  for (std::size_t q = 0; q < queue.size(); ++q) {
    const auto& local = c.local_faces[at(queue[q])];
    const std::array<Vec2, 3> own = own_plane(s, c.faces[at(queue[q])]);
    int side = -1;
    for (int k = 0; k < 3; ++k) {
      if (placed[at(local[at(k)])] && placed[at(local[at((k + 1) % 3)])]) side = k;
    }
    if (side < 0) side = 0;
    const int a = side, b = (side + 1) % 3;
    Vec2 origin = own[at(a)], direction(1, 0);
    if (placed[at(local[at(a)])] && placed[at(local[at(b)])]) {
      origin = c.flat[at(local[at(a)])];
      const Vec2 d = c.flat[at(local[at(b)])] - origin;
      if (d.norm() > 0) direction = d.normalized();
    }
    const Vec2 from = (own[at(b)] - own[at(a)]).normalized();
    const double cosine = from.dot(direction), sine = from.x() * direction.y() - from.y() * direction.x();
    for (int k = 0; k < 3; ++k) {
      if (placed[at(local[at(k)])]) continue;
      const Vec2 d = own[at(k)] - own[at(a)];
      c.flat[at(local[at(k)])] = origin + Vec2(cosine * d.x() - sine * d.y(), sine * d.x() + cosine * d.y());
      placed[at(local[at(k)])] = true;
    }
    for (int k = 0; k < 3; ++k) {
      const FaceIndex next = cut.neighbour(c.faces[at(queue[q])], k);
      const auto found = local_of.find(next);
      if (next < 0 || found == local_of.end() || done[at(found->second)]) continue;
      done[at(found->second)] = true;
      queue.push_back(found->second);
    }
  }
}

struct Solver {
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor;
  std::vector<std::array<double, 3>> weight;  // Entry k is the cotangent of the angle opposite side k.
  std::vector<std::array<Vec2, 3>> own;
  std::vector<std::array<double, 3>> cotangent;
};

void prepare_solver(const mesh::Surface& s, const FlatChart& c, Solver& solver) {
  for (std::size_t f = 0; f < c.faces.size(); ++f) {
    solver.own.push_back(own_plane(s, c.faces[f]));
    std::array<double, 3> w{};
    for (int k = 0; k < 3; ++k) {
      const Vec2 u = solver.own[f][at(k)] - solver.own[f][at((k + 2) % 3)],
                 v = solver.own[f][at((k + 1) % 3)] - solver.own[f][at((k + 2) % 3)];
      const double area = std::abs(u.x() * v.y() - u.y() * v.x());
      // Positive weights keep the system definite.
      w[at(k)] = std::clamp(u.dot(v) / std::max(area, 1e-12), 0.05, 20.0);
    }
    solver.cotangent.push_back(w);
  }
}

// The pattern is analysed once; a new weight per face costs the numeric part alone.
void factorize(const FlatChart& c, const std::vector<double>& face_weight, Solver& solver) {
  const bool first = solver.weight.empty();
  solver.weight = solver.cotangent;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(12 * c.faces.size() + 1);
  for (std::size_t f = 0; f < c.faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const double w = solver.weight[f][at(k)] *= face_weight[f];
      const int i = c.local_faces[f][at(k)], j = c.local_faces[f][at((k + 1) % 3)];
      entries.emplace_back(i, i, w);
      entries.emplace_back(j, j, w);
      entries.emplace_back(i, j, -w);
      entries.emplace_back(j, i, -w);
    }
  }
  entries.emplace_back(0, 0, 1.0);  // This equation fixes the translation.
  Eigen::SparseMatrix<double> matrix(static_cast<Eigen::Index>(c.flat.size()),
                                     static_cast<Eigen::Index>(c.flat.size()));
  matrix.setFromTriplets(entries.begin(), entries.end());
  if (first) solver.factor.analyzePattern(matrix);
  solver.factor.factorize(matrix);
}

// Does one local/global step: the best rotation of every triangle, then the vertices that fit all of them best.
void step(FlatChart& c, const Solver& solver) {
  Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(static_cast<Eigen::Index>(c.flat.size()), 2);
  for (std::size_t f = 0; f < c.faces.size(); ++f) {
    double cosine = 0.0, sine = 0.0;
    for (int k = 0; k < 3; ++k) {
      const Vec2 now = c.flat[at(c.local_faces[f][at((k + 1) % 3)])] - c.flat[at(c.local_faces[f][at(k)])];
      const Vec2 rest = solver.own[f][at((k + 1) % 3)] - solver.own[f][at(k)];
      cosine += solver.weight[f][at(k)] * rest.dot(now);
      sine += solver.weight[f][at(k)] * (rest.x() * now.y() - rest.y() * now.x());
    }
    const double norm = std::hypot(cosine, sine);
    if (norm > 0.0) {
      cosine /= norm;
      sine /= norm;
    } else {
      cosine = 1.0;
    }
    for (int k = 0; k < 3; ++k) {
      const Vec2 rest = solver.own[f][at((k + 1) % 3)] - solver.own[f][at(k)];
      const Vec2 turned =
          solver.weight[f][at(k)] * Vec2(cosine * rest.x() - sine * rest.y(), sine * rest.x() + cosine * rest.y());
      right.row(c.local_faces[f][at((k + 1) % 3)]) += turned.transpose();
      right.row(c.local_faces[f][at(k)]) -= turned.transpose();
    }
  }
  const Eigen::MatrixX2d solution = solver.factor.solve(right);
  for (std::size_t v = 0; v < c.flat.size(); ++v) c.flat[v] = solution.row(static_cast<Eigen::Index>(v)).transpose();
}

// Returns the largest scaled error among the edges of each face.
std::vector<double> face_errors(const FlatChart& c, const Solver& solver) {
  std::vector<double> errors(c.faces.size(), 0.0);
  for (std::size_t f = 0; f < c.faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const double rest = (solver.own[f][at((k + 1) % 3)] - solver.own[f][at(k)]).norm();
      const double flat = (c.flat[at(c.local_faces[f][at((k + 1) % 3)])] - c.flat[at(c.local_faces[f][at(k)])]).norm();
      errors[f] = std::max(errors[f], std::abs(flat - rest) / rest * kSide_mm);
    }
  }
  return errors;
}

// Weights grow where the error is large, so that the largest error falls towards the least possible one.
void even_out(FlatChart& c, Solver& solver, double limit_mm) {
  constexpr int kRounds = 8, kSteps = 5;
  std::vector<double> weight(c.faces.size(), 1.0);
  std::vector<double> errors = face_errors(c, solver);
  double best = *std::ranges::max_element(errors);
  std::vector<Vec2> best_flat = c.flat;
  for (int round = 0; round < kRounds && best > limit_mm; ++round) {
    const double highest = *std::ranges::max_element(errors);
    double sum = 0.0;
    for (std::size_t f = 0; f < weight.size(); ++f) {
      weight[f] *= 0.15 + errors[f] / highest;
      sum += weight[f];
    }
    for (double& w : weight) w *= static_cast<double>(weight.size()) / sum;
    factorize(c, weight, solver);
    for (int k = 0; k < kSteps; ++k) step(c, solver);
    errors = face_errors(c, solver);
    const double now = *std::ranges::max_element(errors);
    if (!(now < best)) continue;
    best = now;
    best_flat = c.flat;
  }
  c.flat = best_flat;
}

}  // namespace

FlatChart flatten(const CutSurface& cut, const std::vector<FaceIndex>& faces, int iterations, double limit_mm,
                  const std::function<bool()>& give_up) {
  constexpr int kCheckEvery = 10;                 // The error is measured once in this many steps.
  constexpr double kHopeless = 6.0, kNear = 2.5;  // Both are multiples of the limit.
  const mesh::Surface& surface = cut.surface();
  FlatChart chart = make_chart(cut, faces);
  unfold_start(cut, chart);
  if (faces.size() < 2) return chart;
  Solver solver;
  prepare_solver(surface, chart, solver);
  factorize(chart, std::vector<double>(faces.size(), 1.0), solver);
  double error = 0.0, before = 1e300;
  // An open dart swings slowly to its place, so a few times as many steps are allowed while they pay off.
  for (int k = 1; k <= iterations || (k <= 5 * iterations && error < 0.98 * before); ++k) {
    if (give_up && give_up()) break;
    step(chart, solver);
    if (k % kCheckEvery != 0 && k != iterations) continue;
    before = error;
    error = std::ranges::max(face_errors(chart, solver));
    if (k > kCheckEvery && (error > kHopeless * limit_mm || std::abs(error - before) < 1e-3 * error || error < 1e-9))
      break;
  }
  if (error > limit_mm && error < kNear * limit_mm) even_out(chart, solver, limit_mm);
  return chart;
}

EdgeError edge_error(const mesh::Surface& surface, const FlatChart& chart) {
  EdgeError error;
  double sum = 0.0;
  for (std::size_t f = 0; f < chart.faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const double length = (corner(surface, chart.faces[f], (k + 1) % 3) - corner(surface, chart.faces[f], k)).norm();
      const double flat =
          (chart.flat[at(chart.local_faces[f][at((k + 1) % 3)])] - chart.flat[at(chart.local_faces[f][at(k)])]).norm();
      const double scaled = std::abs(flat - length) / length * kSide_mm;
      error.max_mm = std::max(error.max_mm, scaled);
      sum += scaled * scaled;
    }
  }
  error.rms_mm = std::sqrt(sum / (3.0 * static_cast<double>(chart.faces.size())));
  return error;
}

bool has_flip(const FlatChart& chart) {
  return std::ranges::any_of(chart.local_faces, [&](const auto& f) {
    const Vec2 u = chart.flat[at(f[1])] - chart.flat[at(f[0])], v = chart.flat[at(f[2])] - chart.flat[at(f[0])];
    return !(u.x() * v.y() - u.y() * v.x() > 0.0);
  });
}

std::vector<std::vector<int>> chart_loops(const FlatChart& chart) {
  std::set<std::pair<int, int>> directed;
  for (const auto& f : chart.local_faces) {
    for (int k = 0; k < 3; ++k) directed.emplace(f[at(k)], f[at((k + 1) % 3)]);
  }
  std::map<int, int> next;  // Vertices are split at pinches, so each has one border edge out.
  for (const auto& [a, b] : directed) {
    if (!directed.contains({b, a})) next[a] = b;
  }
  std::vector<std::vector<int>> loops;
  while (!next.empty()) {
    std::vector<int> loop;
    int v = next.begin()->first;
    for (auto edge = next.find(v); edge != next.end(); edge = next.find(v)) {
      loop.push_back(v);
      v = edge->second;
      next.erase(edge);
    }
    loops.push_back(std::move(loop));
  }
  std::ranges::sort(loops, std::greater<>(), [&](const std::vector<int>& loop) {
    double length = 0.0;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      length += (chart.flat[at(loop[(k + 1) % loop.size()])] - chart.flat[at(loop[k])]).norm();
    }
    return length;
  });
  return loops;
}

}  // namespace triskin::unfolding
