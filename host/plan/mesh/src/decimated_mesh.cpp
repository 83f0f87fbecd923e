// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mesh/decimated_mesh.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "collapsing_mesh.hpp"
#include "triskin/base/index.hpp"
#include "triskin/base/parallel.hpp"

namespace triskin::mesh {
namespace {

constexpr int kLevels = 7;              // Each level lets an edge that follows a bend be twice as long.
constexpr double kBetweenLevels = 4.0;  // The allowed deviation grows by this factor between levels.
constexpr std::size_t kChunk = 512;     // A thread takes this many corners at once.
constexpr std::size_t kFewFaces = 5000;
constexpr double kWideFace_mm2 = 4.0;  // Such a face is as wide as the cells in which closest points are looked for.
constexpr double kWorthwhile = 0.5;    // A decimated mesh with more than half of the faces is not worth it.
constexpr double kOfLimit = 0.05;      // The deviation may take this share of the narrowest limit.
constexpr double kMinLimit = 0.5;      // At least half of each limit is left.

// Collapses corners in rounds. No two corners of a round are neighbours, so that the measurements of one remain valid
// when others are collapsed. A corner that cannot be collapsed is tried again only when its faces change or more
// deviation is allowed.
class Reducer {
 public:
  Reducer(const Surface& surface, double border_mm, int threads)
      : mesh_(surface),
        border_mm_(border_mm),
        threads_(threads),
        needs_mm_(surface.mesh().vertices.size(), 0.0F),
        is_waiting_(needs_mm_.size(), 0),
        is_blocked_(needs_mm_.size(), 0) {}

  DecimatedMesh run(double deviation_mm, std::size_t enough_faces) {
    double share = 1.0;
    for (int level = 1; level < kLevels; ++level) share /= kBetweenLevels;
    for (int level = 0; level < kLevels && mesh_.n_faces() > enough_faces; ++level, share *= kBetweenLevels)
      take_out(share * deviation_mm);
    return {mesh_.mesh(), mesh_.deviation_mm(), mesh_.border_mm()};
  }

 private:
  void take_out(double deviation_mm) {
    for (std::size_t v = 0; v < needs_mm_.size(); ++v) {
      if (static_cast<double>(needs_mm_[v]) <= deviation_mm) wait(VertexIndex(v));
    }
    while (!waiting_.empty()) {
      choose();
      moves_.resize(chosen_.size());
      in_parallel(threads_, (chosen_.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
        const std::size_t end = std::min(chosen_.size(), (chunk + 1) * kChunk);
        for (std::size_t k = chunk * kChunk; k < end; ++k)
          moves_[k] = mesh_.best_move(chosen_[k], deviation_mm, border_mm_);
      });
      move();
    }
  }

  void wait(VertexIndex vertex) {
    if (is_waiting_[at(vertex)]) return;
    is_waiting_[at(vertex)] = 1;
    waiting_.push_back(vertex);
  }

  // Chooses waiting corners of which no two are neighbours; the others keep waiting.
  void choose() {
    chosen_.clear();
    std::vector<VertexIndex> later, blocked;
    CollapsingMesh::Ring ring;
    for (const VertexIndex v : waiting_) {
      if (is_blocked_[at(v)]) {
        later.push_back(v);
        continue;
      }
      is_waiting_[at(v)] = 0;
      if (!mesh_.ring_of(v, ring)) continue;
      chosen_.push_back(v);
      for (std::size_t k = 0; k < ring.n_corners; ++k) {
        is_blocked_[at(ring.corners[k])] = 1;
        blocked.push_back(ring.corners[k]);
      }
    }
    for (const VertexIndex v : blocked) is_blocked_[at(v)] = 0;
    waiting_ = std::move(later);
  }

  void move() {
    for (std::size_t k = 0; k < chosen_.size(); ++k) {
      const VertexIndex v = chosen_[k];
      changed_.clear();
      if (moves_[k].onto < 0 || !mesh_.collapse(v, moves_[k], changed_)) {
        needs_mm_[at(v)] = static_cast<float>(moves_[k].needs_mm);
        continue;
      }
      for (const VertexIndex c : changed_) {
        needs_mm_[at(c)] = 0.0F;
        wait(c);
      }
    }
  }

  CollapsingMesh mesh_;
  double border_mm_;
  int threads_;
  std::vector<float> needs_mm_;  // Below this deviation no move of the vertex is possible.
  std::vector<char> is_waiting_, is_blocked_;
  std::vector<VertexIndex> waiting_, chosen_, changed_;
  std::vector<CollapsingMesh::Move> moves_;
};

}  // namespace

DecimatedMesh decimate(const Surface& surface, double deviation_mm, double border_mm, int threads,
                       std::size_t enough_faces) {
  return Reducer(surface, border_mm, threads).run(deviation_mm, enough_faces);
}

std::optional<DecimatedMesh> solver_mesh_of(const Surface& surface, const LayoutLimits& limits, double deviation_mm,
                                            int threads) {
  const std::size_t faces = surface.mesh().faces.size();
  if (!(deviation_mm > 0.0) || faces < kFewFaces || surface.area_mm2() > kWideFace_mm2 * static_cast<double>(faces))
    return std::nullopt;
  const double narrowest_mm = std::min({limits.lift_mm, limits.depth_mm, limits.center_gap_mm});
  DecimatedMesh solver = decimate(surface, std::min(deviation_mm, kOfLimit * narrowest_mm),
                                  std::min({deviation_mm, kSolverBorder_mm, kOfLimit * limits.overrun_mm}), threads);
  if (static_cast<double>(solver.mesh.faces.size()) > kWorthwhile * static_cast<double>(faces)) return std::nullopt;
  return solver;
}

LayoutLimits limits_on(const DecimatedMesh& solver, LayoutLimits limits) {
  for (double* limit : {&limits.lift_mm, &limits.depth_mm, &limits.center_gap_mm})
    *limit = std::max(kMinLimit * *limit, *limit - solver.deviation_mm);
  limits.overrun_mm = std::max(kMinLimit * limits.overrun_mm, limits.overrun_mm - solver.border_mm);
  return limits;
}

}  // namespace triskin::mesh
