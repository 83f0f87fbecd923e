// SPDX-License-Identifier: GPL-3.0-or-later
#include "collapsing_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "triskin/base/index.hpp"

namespace triskin::mesh {
namespace {

// This is far above the rounding of some hundred operations on lengths of metres, which is one step.
constexpr double kRounding_mm = 1e-9;

// A shape that uses all of the allowed deviation counts a fourth of one that uses none.
constexpr double kPrefersFlat = 3.0;

std::size_t corner_in(const std::array<int, 3>& face, VertexIndex vertex) {
  return face[0] == vertex ? 0 : face[1] == vertex ? 1 : 2;
}

float upwards(double x) {
  const auto rounded = static_cast<float>(x);
  return static_cast<double>(rounded) < x ? std::nextafter(rounded, std::numeric_limits<float>::infinity()) : rounded;
}

}  // namespace

CollapsingMesh::CollapsingMesh(const Surface& surface)
    : places_(surface.mesh().vertices),
      faces_(surface.mesh().faces),
      n_faces_(faces_.size()),
      face_of_(places_.size(), FaceIndex::none()),
      is_locked_(places_.size(), 0),
      deviation_(faces_.size(), 0.0F),
      border_(places_.size(), 0.0F) {
  std::vector<int> n_faces(places_.size(), 0);
  neighbours_.reserve(faces_.size());
  for (FaceIndex f{0}; f < static_cast<int>(faces_.size()); ++f) {
    neighbours_.push_back(surface.neighbours(f));
    for (const int v : faces_[at(f)]) {
      face_of_[at(v)] = f;
      ++n_faces[at(v)];
    }
  }
  Ring ring;
  for (std::size_t v = 0; v < places_.size(); ++v) {
    const bool is_fan = ring_of(VertexIndex(v), ring) && ring.n_faces == at(n_faces[v]);
    is_locked_[v] = is_fan ? 0 : 1;
  }
}

bool CollapsingMesh::ring_of(VertexIndex vertex, Ring& ring) const {
  const FaceIndex any = face_of_[at(vertex)];
  if (any < 0 || is_locked_[at(vertex)]) return false;
  FaceIndex first = any;
  for (std::size_t turns = 0;; ++turns) {  // The walk goes clockwise to the border, or once round the vertex.
    const FaceIndex before = neighbours_[at(first)][corner_in(faces_[at(first)], vertex)];
    if (before < 0 || before == any) break;
    if (turns > FlatStar::kMaxCorners) return false;
    first = before;
  }
  ring.n_faces = ring.n_corners = 0;
  for (FaceIndex f = first; ring.n_corners + 2 < FlatStar::kMaxCorners;) {
    const auto& face = faces_[at(f)];
    const std::size_t c = corner_in(face, vertex);
    ring.faces[ring.n_faces++] = f;
    ring.corners[ring.n_corners++] = VertexIndex(face[(c + 1) % 3]);
    const FaceIndex next = neighbours_[at(f)][(c + 2) % 3];
    if (next < 0) ring.corners[ring.n_corners++] = VertexIndex(face[(c + 2) % 3]);
    if (next < 0 || next == first) return ring.is_open() || ring.n_faces >= 3;
    f = next;
  }
  return false;
}

CollapsingMesh::Move CollapsingMesh::best_move(VertexIndex vertex, double deviation_mm, double border_mm) const {
  Move best;
  best.needs_mm = std::numeric_limits<double>::infinity();
  Ring ring;
  if (!ring_of(vertex, ring) || ring.n_faces < 2) return best;
  std::array<Vec3, FlatStar::kMaxCorners> around;
  for (std::size_t k = 0; k < ring.n_corners; ++k) around[k] = place(ring.corners[k]);
  const FlatStar star(place(vertex), {around.data(), ring.n_corners}, ring.is_open());
  if (!star.is_flat()) return best;
  double before_mm = 0.0, border_before_mm = 0.0;
  for (std::size_t k = 0; k < ring.n_faces; ++k)
    before_mm = std::max(before_mm, static_cast<double>(deviation_[at(ring.faces[k])]));
  // A border edge begins at the middle, and one at the neighbour before it.
  const VertexIndex last = ring.corners[ring.n_corners - 1];
  if (ring.is_open()) border_before_mm = static_cast<double>(std::max(border_[at(vertex)], border_[at(last)]));
  double best_value = -1.0;
  for (std::size_t j = 0; j < ring.n_corners; j += ring.is_open() ? ring.n_corners - 1 : 1) {
    if (is_locked_[at(ring.corners[j])]) continue;
    const auto change = star.onto(j);
    if (!change) continue;
    const double border = border_before_mm + change->border_mm + (ring.is_open() ? kRounding_mm : 0.0);
    if (ring.is_open() && border > border_mm) continue;
    const double deviation = before_mm + change->deviation_mm + kRounding_mm;
    best.needs_mm = std::min(best.needs_mm, deviation);
    const double value = change->shape / (1.0 + kPrefersFlat * change->deviation_mm / deviation_mm);
    if (deviation > deviation_mm || value <= best_value || !keeps_edges_single(vertex, ring, j)) continue;
    best_value = value;
    best.onto = ring.corners[j];
    best.deviation_mm = deviation;
    best.border_mm = border;
  }
  return best;
}

// Their common neighbours must be exactly those at the edge between them, and no single new side may already have a
// face beyond it.
bool CollapsingMesh::keeps_edges_single(VertexIndex vertex, const Ring& ring, std::size_t j) const {
  Ring around;
  if (!ring_of(ring.corners[j], around)) return false;
  const std::span<const VertexIndex> corners(ring.corners.data(), ring.n_corners),
      others(around.corners.data(), around.n_corners);
  const auto common =
      std::ranges::count_if(corners, [&](VertexIndex v) { return std::ranges::find(others, v) != others.end(); });
  if (common != (ring.is_open() ? 1 : 2)) return false;
  if (ring.is_open() || ring.n_faces > 3) return true;
  const auto in_ring = [&](int v) { return v != vertex && std::ranges::find(corners, v) != corners.end(); };
  return std::ranges::none_of(std::span<const FaceIndex>(around.faces.data(), around.n_faces),
                              [&](FaceIndex f) { return std::ranges::all_of(faces_[at(f)], in_ring); });
}

// Sets the neighbour across the side from one corner to the next.
void CollapsingMesh::point_side(FaceIndex face, VertexIndex from, VertexIndex to, FaceIndex neighbour) {
  if (face < 0) return;
  for (std::size_t s = 0; s < 3; ++s) {
    if (faces_[at(face)][s] == from && faces_[at(face)][(s + 1) % 3] == to) neighbours_[at(face)][s] = neighbour;
  }
}

// Removes a face with the middle and the corner onto which it is collapsed, and joins the neighbours at its two other
// sides.
void CollapsingMesh::remove_face(FaceIndex face, VertexIndex vertex, VertexIndex corner) {
  const auto f = faces_[at(face)];
  const auto sides = neighbours_[at(face)];
  const std::size_t v = corner_in(f, vertex), c = corner_in(f, corner);
  const VertexIndex third(f[3 - v - c]);
  const auto opposite = [&](std::size_t k) { return sides[(k + 1) % 3]; };  // Returns the neighbour opposite corner k.
  const FaceIndex inner = opposite(c), outer = opposite(v);
  // The side of `one` between `end` and the third corner is joined to `other`.
  const auto join = [&](FaceIndex one, VertexIndex end, FaceIndex other) {
    point_side(one, end, third, other);
    point_side(one, third, end, other);
  };
  join(inner, vertex, outer);
  join(outer, corner, inner);
  if (face_of_[at(third)] == face) face_of_[at(third)] = inner;
  faces_[at(face)] = {-1, -1, -1};
  --n_faces_;
}

bool CollapsingMesh::collapse(VertexIndex vertex, const Move& move, std::vector<VertexIndex>& changed) {
  Ring ring;
  if (!ring_of(vertex, ring)) return false;
  const auto end = ring.corners.begin() + static_cast<std::ptrdiff_t>(ring.n_corners);
  const auto j = static_cast<std::size_t>(std::find(ring.corners.begin(), end, move.onto) - ring.corners.begin());
  if (j == ring.n_corners || !keeps_edges_single(vertex, ring, j)) return false;
  const VertexIndex before = ring.corners[ring.n_corners - 1];
  for (std::size_t k = 0; k < ring.n_faces; ++k) {
    const FaceIndex f = ring.faces[k];
    const auto& corners = faces_[at(f)];
    if (std::ranges::find(corners, move.onto) != corners.end()) remove_face(f, vertex, move.onto);
  }
  for (std::size_t k = 0; k < ring.n_faces; ++k) {
    const FaceIndex f = ring.faces[k];
    if (faces_[at(f)][0] < 0) continue;
    faces_[at(f)][corner_in(faces_[at(f)], vertex)] = move.onto;
    deviation_[at(f)] = upwards(move.deviation_mm);
    face_of_[at(move.onto)] = f;
  }
  if (ring.is_open()) border_[at(before)] = upwards(move.border_mm);
  face_of_[at(vertex)] = FaceIndex::none();
  changed.insert(changed.end(), ring.corners.begin(), end);
  return true;
}

Mesh CollapsingMesh::mesh() const {
  Mesh left;
  std::vector<int> number(places_.size(), -1);
  for (const auto& f : faces_) {
    for (const int v : f) {
      if (v >= 0) number[at(v)] = 0;
    }
  }
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<int>(left.vertices.size());
    left.vertices.push_back(places_[v]);
  }
  for (const auto& f : faces_) {
    if (f[0] >= 0) left.faces.push_back({number[at(f[0])], number[at(f[1])], number[at(f[2])]});
  }
  return left;
}

double CollapsingMesh::deviation_mm() const {
  float most = 0.0F;
  for (std::size_t f = 0; f < faces_.size(); ++f) most = std::max(most, faces_[f][0] < 0 ? 0.0F : deviation_[f]);
  return static_cast<double>(most);
}

double CollapsingMesh::border_mm() const {
  float most = 0.0F;
  for (std::size_t v = 0; v < border_.size(); ++v) most = std::max(most, face_of_[v] < 0 ? 0.0F : border_[v]);
  return static_cast<double>(most);
}

}  // namespace triskin::mesh
