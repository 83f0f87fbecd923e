// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/geometry/unfolding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>

#include "flatten.hpp"
#include "merge_pieces.hpp"
#include "triskin/geometry/polygon_io.hpp"
#include "triskin/host/error.hpp"

namespace triskin::geometry {
namespace {

std::size_t at(int k) { return static_cast<std::size_t>(k); }

class Unfolder {
 public:
  Unfolder(const Surface& surface, const UnfoldingOptions& options, const ProgressSink& progress)
      : surface_(surface), options_(options), progress_(progress), member_(surface.mesh().faces.size(), 0) {
    for (const auto& f : surface.mesh().faces) {
      const auto& v = surface.mesh().vertices;
      middle_.push_back((v[at(f[0])] + v[at(f[1])] + v[at(f[2])]) / 3.0);
    }
  }

  Net run() {
    std::vector<int> all(surface_.mesh().faces.size());
    for (std::size_t f = 0; f < all.size(); ++f) all[f] = static_cast<int>(f);
    std::vector<std::vector<int>> open = connected(all);
    std::size_t done = 0;
    while (!open.empty()) {
      std::vector<int> faces = std::move(open.back());
      open.pop_back();
      if (auto piece = try_piece(faces)) {
        done += faces.size();
        net_.pieces.push_back(std::move(*piece));
        report(progress_, "unfolding", static_cast<double>(done) / static_cast<double>(all.size()));
        continue;
      }
      for (auto& part : divide(faces)) open.push_back(std::move(part));
    }
    merge_pieces(surface_, net_.pieces, [this](const std::vector<int>& faces) { return try_piece(faces); }, progress_);
    std::ranges::stable_sort(net_.pieces, std::greater<>(), [](const Piece& p) { return polygon_area(p.outline); });
    return std::move(net_);
  }

 private:
  // Parts of a face set that hang together by edges.
  std::vector<std::vector<int>> connected(const std::vector<int>& faces) {
    const int mark = ++stamp_;
    for (const int f : faces) member_[at(f)] = mark;
    std::vector<std::vector<int>> parts;
    for (const int start : faces) {
      if (member_[at(start)] != mark) continue;
      std::vector<int> part{start};
      member_[at(start)] = 0;
      for (std::size_t k = 0; k < part.size(); ++k) {
        for (const int n : surface_.neighbours(part[k])) {
          if (n < 0 || member_[at(n)] != mark) continue;
          member_[at(n)] = 0;
          part.push_back(n);
        }
      }
      std::ranges::sort(part);
      parts.push_back(std::move(part));
    }
    return parts;
  }

  std::optional<Piece> try_piece(const std::vector<int>& faces) {
    if (faces.size() > 1 && turns_too_far(faces)) return std::nullopt;
    const FlatChart chart = flatten(surface_, faces, options_.iterations, options_.edge_error_mm);
    const EdgeError error = edge_error(surface_, chart);
    if (faces.size() > 1 && (has_flip(chart) || !(error.max_mm <= options_.edge_error_mm))) return std::nullopt;
    Piece piece;
    piece.max_edge_error_mm = error.max_mm;
    piece.rms_edge_error_mm = error.rms_mm;
    piece.faces = faces;
    for (const auto& f : chart.local_faces) piece.flat.push_back({chart.flat[at(f[0])], chart.flat[at(f[1])], chart.flat[at(f[2])]});
    const auto loops = chart_loops(chart);
    if (loops.empty()) return std::nullopt;  // closed
    for (std::size_t k = 0; k < loops.size(); ++k) {
      std::vector<Vec2> ring;
      for (const int v : loops[k]) ring.push_back(chart.flat[at(v)]);
      if (k == 0) piece.outline.outer = std::move(ring);
      else piece.outline.holes.push_back(std::move(ring));
    }
    return simple(piece) ? std::optional(std::move(piece)) : std::nullopt;
  }

  // A full turn of the normals (a tube, a ball) never flattens: saves the solve.
  bool turns_too_far(const std::vector<int>& faces) const {
    Vec3 sum = Vec3::Zero();
    double area = 0.0;
    for (const int f : faces) {
      const auto& c = surface_.mesh().faces[at(f)];
      const auto& v = surface_.mesh().vertices;
      const double twice = (v[at(c[1])] - v[at(c[0])]).cross(v[at(c[2])] - v[at(c[0])]).norm();
      sum += twice * surface_.face_normal(f);
      area += twice;
    }
    return sum.norm() < 1e-3 * area;
  }

  // The outline must not cross itself and must have the area of its triangles: then no two of them overlap.
  bool simple(Piece& piece) const {
    double area = 0.0;
    for (const auto& t : piece.flat) {
      const Vec2 u = t[1] - t[0], v = t[2] - t[0];
      area += 0.5 * (u.x() * v.y() - u.y() * v.x());
    }
    if (!(ring_area(piece.outline.outer) > 0.0)) return false;
    try {
      piece.outline = normalize_polygon(piece.outline, "piece");
    } catch (const InputError&) {
      return false;
    }
    return std::abs(polygon_area(piece.outline) - area) <= 1e-6 * area;
  }

  // Two faces far apart over the dual graph, then each face to the nearer one.
  std::vector<std::vector<int>> divide(const std::vector<int>& faces) {
    const auto farthest = [&](int from) {
      const auto d = distances(faces, from);
      int best = faces.front();
      for (const int f : faces) {
        if (d[at(f)] > d[at(best)]) best = f;
      }
      return best;
    };
    const int a = farthest(faces.front()), b = farthest(a);
    const auto da = distances(faces, a), db = distances(faces, b);
    std::array<std::vector<int>, 2> halves;
    for (const int f : faces) halves[da[at(f)] <= db[at(f)] ? 0 : 1].push_back(f);
    std::vector<std::vector<int>> parts;
    for (const auto& half : halves) {
      for (auto& part : connected(half)) parts.push_back(std::move(part));
    }
    return parts;
  }

  // Along the dual graph of the faces; by face of the surface, infinite outside.
  std::vector<double> distances(const std::vector<int>& faces, int from) {
    const int mark = ++stamp_;
    for (const int f : faces) member_[at(f)] = mark;
    std::vector<double> d(member_.size(), std::numeric_limits<double>::infinity());
    using Item = std::pair<double, int>;
    std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
    d[at(from)] = 0.0;
    queue.emplace(0.0, from);
    while (!queue.empty()) {
      const auto [distance, f] = queue.top();
      queue.pop();
      if (distance > d[at(f)]) continue;
      for (const int n : surface_.neighbours(f)) {
        if (n < 0 || member_[at(n)] != mark) continue;
        const double next = distance + (middle_[at(n)] - middle_[at(f)]).norm();
        if (!(next < d[at(n)])) continue;
        d[at(n)] = next;
        queue.emplace(next, n);
      }
    }
    return d;
  }

  const Surface& surface_;
  const UnfoldingOptions options_;
  const ProgressSink& progress_;
  std::vector<Vec3> middle_;
  std::vector<int> member_;
  int stamp_ = 0;
  Net net_;
};

}  // namespace

Net unfold(const Surface& surface, const UnfoldingOptions& options, const ProgressSink& progress) {
  return Unfolder(surface, options, progress).run();
}

}  // namespace triskin::geometry
