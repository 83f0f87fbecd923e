// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <set>

#include "dart.hpp"
#include "flatten.hpp"
#include "merge_pieces.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/index.hpp"
#include "triskin/placement/polygon_io.hpp"
#include "triskin/unfolding/unfolding.hpp"

namespace triskin::unfolding {
namespace {

using Faces = std::vector<FaceIndex>;

class Unfolder {
 public:
  Unfolder(const mesh::Surface& surface, const UnfoldingOptions& options, const ProgressSink& progress)
      : surface_(surface),
        cut_(surface),
        options_(options),
        progress_(progress),
        member_(surface.mesh().faces.size(), 0),
        group_(member_.size()) {
    for (const auto& f : surface.mesh().faces) {
      const auto& v = surface.mesh().vertices;
      middle_.push_back((v[at(f[0])] + v[at(f[1])] + v[at(f[2])]) / 3.0);
    }
    join_uncut();
    for (const auto& [face, side] : options.seams) {
      if (uncut_.contains(edge_of(face, side))) {
        const Vec3 p = corner(face, side);
        throw InputError(fmt::format(
            "seams: the edge at ({:.2f}, {:.2f}, {:.2f}) is asked for and forbidden; take it out of one of the files",
            p.x(), p.y(), p.z()));
      }
      cut_.set(face, side, true);
    }
  }

  Net run() {
    Faces all(surface_.mesh().faces.size());
    for (std::size_t f = 0; f < all.size(); ++f) all[f] = FaceIndex(f);
    std::vector<Faces> open = connected(all);
    std::size_t done = 0;
    while (!open.empty()) {
      if (gave_up()) return {};
      Faces faces = std::move(open.back());
      open.pop_back();
      auto piece = try_piece(faces);
      if (!piece) piece = darted(faces);
      if (piece) {
        done += faces.size();
        net_.pieces.push_back(std::move(*piece));
        report(progress_, "unfolding", static_cast<double>(done) / static_cast<double>(all.size()));
        continue;
      }
      for (auto& part : divide(faces)) open.push_back(std::move(part));
    }
    merge_pieces(cut_, net_.pieces, [this](const Faces& faces) { return try_piece(faces); }, progress_);
    std::ranges::stable_sort(net_.pieces, std::greater<>(),
                             [](const Piece& p) { return placement::polygon_area(p.outline); });
    return std::move(net_);
  }

 private:
  // Splits a set of faces into parts that are connected by edges.
  std::vector<Faces> connected(const Faces& faces) {
    const int mark = ++stamp_;
    for (const FaceIndex f : faces) member_[at(f)] = mark;
    std::vector<Faces> parts;
    for (const FaceIndex start : faces) {
      if (member_[at(start)] != mark) continue;
      Faces part{start};
      member_[at(start)] = 0;
      for (std::size_t k = 0; k < part.size(); ++k) {
        for (int side = 0; side < 3; ++side) {
          const FaceIndex n = cut_.neighbour(part[k], side);
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

  std::optional<Piece> try_piece(const Faces& faces) {
    if (gave_up() || (faces.size() > 1 && turns_too_far(faces))) return std::nullopt;
    const FlatChart chart = flatten(cut_, faces, options_.iterations, options_.edge_error_mm, options_.give_up);
    const EdgeError error = edge_error(surface_, chart);
    if (faces.size() > 1 && (has_flip(chart) || !(error.max_mm <= options_.edge_error_mm))) return std::nullopt;
    Piece piece;
    piece.max_edge_error_mm = error.max_mm;
    piece.rms_edge_error_mm = error.rms_mm;
    piece.faces = faces;
    for (const auto& f : chart.local_faces)
      piece.flat.push_back({chart.flat[at(f[0])], chart.flat[at(f[1])], chart.flat[at(f[2])]});
    const auto loops = chart_loops(chart);
    if (loops.empty()) return std::nullopt;  // The piece is closed.
    for (std::size_t k = 0; k < loops.size(); ++k) {
      std::vector<Vec2> ring;
      for (const int v : loops[k]) ring.push_back(chart.flat[at(v)]);
      if (k == 0)
        piece.outline.outer = std::move(ring);
      else
        piece.outline.holes.push_back(std::move(ring));
    }
    return simple(piece) ? std::optional(std::move(piece)) : std::nullopt;
  }

  [[nodiscard]] bool gave_up() const { return options_.give_up && options_.give_up(); }

  // A full turn of the normals (a tube, a ball) never flattens unless a seam of the user opens it, so the solve can be
  // skipped.
  bool turns_too_far(const Faces& faces) const {
    Vec3 sum = Vec3::Zero();
    double area = 0.0;
    for (const FaceIndex f : faces) {
      const auto& c = surface_.mesh().faces[at(f)];
      const auto& v = surface_.mesh().vertices;
      const double twice = (v[at(c[1])] - v[at(c[0])]).cross(v[at(c[2])] - v[at(c[0])]).norm();
      sum += twice * surface_.face_normal(f);
      area += twice;
    }
    return options_.seams.empty() && sum.norm() < 1e-3 * area;
  }

  // The outline must not cross itself and must have the area of its triangles: then no two of them overlap.
  bool simple(Piece& piece) const {
    double area = 0.0;
    for (const auto& t : piece.flat) {
      const Vec2 u = t[1] - t[0], v = t[2] - t[0];
      area += 0.5 * (u.x() * v.y() - u.y() * v.x());
    }
    if (!(placement::ring_area(piece.outline.outer) > 0.0)) return false;
    try {
      piece.outline = placement::normalize_polygon(piece.outline, "piece");
    } catch (const InputError&) {
      return false;
    }
    // The tolerance with which readers accept touching edges is too wide here: such edges mean that two pieces of
    // surface cross.
    return !placement::crosses_itself(piece.outline) &&
           std::abs(placement::polygon_area(piece.outline) - area) <= 1e-6 * area;
  }

  // Finds two faces far apart over the dual graph, then assigns each face (with those it must stay joined to) to the
  // nearer one.
  std::vector<Faces> divide(const Faces& faces) {
    const auto farthest = [&](FaceIndex from) {
      const auto d = distances(faces, from);
      FaceIndex best = FaceIndex::none();
      for (const FaceIndex f : faces) {
        if (group_[at(f)] != group_[at(from)] && (best < 0 || d[at(f)] > d[at(best)])) best = f;
      }
      if (best < 0) refuse(faces);
      return best;
    };
    const FaceIndex a = farthest(faces.front()), b = farthest(a);
    const auto da = distances(faces, a), db = distances(faces, b);
    std::map<int, double> nearer_to_b;  // A positive value assigns the group to b.
    for (const FaceIndex f : faces) nearer_to_b[group_[at(f)]] += da[at(f)] - db[at(f)];
    nearer_to_b[group_[at(a)]] = -1.0;
    nearer_to_b[group_[at(b)]] = 1.0;
    std::array<Faces, 2> halves;
    for (const FaceIndex f : faces) halves[nearer_to_b[group_[at(f)]] <= 0.0 ? 0 : 1].push_back(f);
    std::vector<Faces> parts;
    for (const auto& half : halves) {
      for (auto& part : connected(half)) parts.push_back(std::move(part));
    }
    return parts;
  }

  [[noreturn]] void refuse(const Faces& faces) const {
    const Vec3& p = middle_[at(faces.front())];
    throw InputError(
        fmt::format("uncut lines: {} faces near ({:.1f}, {:.1f}, {:.1f}) must stay joined and cannot be laid flat "
                    "within an edge error of {} mm; shorten the "
                    "lines there or allow a larger edge error",
                    faces.size(), p.x(), p.y(), p.z(), options_.edge_error_mm));
  }

  // Distances follow the dual graph; the index is the face of the surface, and faces outside have infinity.
  std::vector<double> distances(const Faces& faces, FaceIndex from) {
    const int mark = ++stamp_;
    for (const FaceIndex f : faces) member_[at(f)] = mark;
    std::vector<double> d(member_.size(), std::numeric_limits<double>::infinity());
    using Item = std::pair<double, FaceIndex>;
    std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
    d[at(from)] = 0.0;
    queue.emplace(0.0, from);
    while (!queue.empty()) {
      const auto [distance, f] = queue.top();
      queue.pop();
      if (distance > d[at(f)]) continue;
      for (int side = 0; side < 3; ++side) {
        const FaceIndex n = cut_.neighbour(f, side);
        if (n < 0 || member_[at(n)] != mark) continue;
        const double next = distance + (middle_[at(n)] - middle_[at(f)]).norm();
        if (!(next < d[at(n)])) continue;
        d[at(n)] = next;
        queue.emplace(next, n);
      }
    }
    return d;
  }

  [[nodiscard]] VertexPair edge_of(FaceIndex face, int side) const {
    const auto& f = surface_.mesh().faces[at(face)];
    return std::minmax({VertexIndex(f[at(side)]), VertexIndex(f[at((side + 1) % 3)])});
  }
  [[nodiscard]] const Vec3& corner(FaceIndex face, int k) const {
    return surface_.mesh().vertices[at(surface_.mesh().faces[at(face)][at(k)])];
  }

  // Faces that must stay joined get the same group.
  void join_uncut() {
    for (std::size_t f = 0; f < group_.size(); ++f) group_[f] = static_cast<int>(f);
    const auto root = [&](int f) {
      while (group_[at(f)] != f) f = group_[at(f)];
      return f;
    };
    for (const auto& [face, side] : options_.uncut) {
      uncut_.insert(edge_of(face, side));
      const FaceIndex other = surface_.neighbours(face)[at(side)];
      if (other >= 0) group_[at(root(other))] = root(face);
    }
    for (std::size_t f = 0; f < group_.size(); ++f) group_[f] = root(static_cast<int>(f));
  }

  // Cuts along the shortest paths from the border to inner vertices, the farthest from it first, until the faces lie
  // flat. Undoes all cuts if the faces do not become flat or the cuts are longer than the seam needed for splitting.
  std::optional<Piece> darted(const Faces& faces) {
    if (faces.size() < 12 || turns_too_far(faces)) return std::nullopt;
    double left_mm = 0.7 * std::sqrt(area_of(faces));  // A seam across the piece is longer than this.
    std::vector<SurfaceEdge> made;
    for (int k = 0; k < options_.darts; ++k) {
      const std::vector<SurfaceEdge> dart = deepest_dart(cut_, faces, uncut_);
      double length = 0.0;
      for (const auto& [face, side] : dart) length += (corner(face, (side + 1) % 3) - corner(face, side)).norm();
      left_mm -= length;
      if (dart.empty() || left_mm < 0.0) break;
      for (const auto& [face, side] : dart) cut_.set(face, side, true);
      made.insert(made.end(), dart.begin(), dart.end());
      if (auto piece = try_piece(faces)) return piece;
    }
    for (const auto& [face, side] : made) cut_.set(face, side, false);
    return std::nullopt;
  }

  [[nodiscard]] double area_of(const Faces& faces) const {
    double area = 0.0;
    for (const FaceIndex f : faces)
      area += 0.5 * (corner(f, 1) - corner(f, 0)).cross(corner(f, 2) - corner(f, 0)).norm();
    return area;
  }

  const mesh::Surface& surface_;
  CutSurface cut_;
  const UnfoldingOptions options_;
  const ProgressSink& progress_;
  std::vector<Vec3> middle_;
  std::vector<int> member_, group_;
  std::set<VertexPair> uncut_;
  int stamp_ = 0;
  Net net_;
};

}  // namespace

Net unfold(const mesh::Surface& surface, const UnfoldingOptions& options, const ProgressSink& progress) {
  return Unfolder(surface, options, progress).run();
}

}  // namespace triskin::unfolding
