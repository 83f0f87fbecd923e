// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mesh/extract.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <span>
#include <unordered_set>

#include "edge_sides.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/index.hpp"
#include "triskin/design/design_types.hpp"
#include "triskin/mesh/decimated_mesh.hpp"
#include "triskin/mesh/extract_steps.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::mesh {
namespace {

int boundary_loops_of(const Mesh& mesh) {
  return static_cast<int>(border_loops_of(mesh, neighbours_of(mesh)).size());
}

class Extractor {
 public:
  explicit Extractor(const Mesh& mesh) : mesh_(mesh) {}

  Extraction run() {
    pair_faces();
    orient_components();
    keep_large_components();
    rebuild();
    Extraction out{std::move(result_), report_};
    out.report.boundary_loops = boundary_loops_of(out.surface);
    return out;
  }

 private:
  [[nodiscard]] Vec3 cross_of(FaceIndex face) const {
    const auto& f = mesh_.faces[at(face)];
    const Vec3 &a = mesh_.vertices[at(f[0])], &b = mesh_.vertices[at(f[1])], &c = mesh_.vertices[at(f[2])];
    return (b - a).cross(c - a);
  }

  // At an edge with more than two faces only the flattest pair stays joined; there the others get a border.
  void pair_faces() {
    constexpr FaceIndex kNone = FaceIndex::none();
    neighbour_.assign(mesh_.faces.size(), {kNone, kNone, kNone});
    const EdgeSides sides(mesh_);
    sides.each_edge([&](std::span<const EdgeSide> edge) {
      if (edge.size() < 2) return;
      report_.non_manifold_edges += edge.size() > 2 ? 1 : 0;
      has_unjoined_ = has_unjoined_ || edge.size() > 2 || edge[0].low == edge[0].high || edge[0].face == edge[1].face;
      const auto [first, second] = flattest_pair(edge);
      const EdgeSide &a = edge[first], &b = edge[second];
      neighbour_[at(a.face)][at(a.side)] = b.face;
      neighbour_[at(b.face)][at(b.side)] = a.face;
    });
  }
  [[nodiscard]] std::pair<std::size_t, std::size_t> flattest_pair(std::span<const EdgeSide> edge) const {
    std::pair<std::size_t, std::size_t> best{0, 1};
    if (edge.size() == 2) return best;
    double flattest = -2.0;
    for (std::size_t i = 0; i < edge.size(); ++i) {
      for (std::size_t k = i + 1; k < edge.size(); ++k) {
        const bool same_direction = start(edge[i]) == start(edge[k]);
        const double cosine =
            cross_of(edge[i].face).normalized().dot(cross_of(edge[k].face).normalized()) * (same_direction ? -1 : 1);
        if (cosine > flattest) {
          flattest = cosine;
          best = {i, k};
        }
      }
    }
    return best;
  }
  [[nodiscard]] int start(const EdgeSide& s) const { return start(s.face, s.side); }
  [[nodiscard]] int start(FaceIndex face, int side) const { return mesh_.faces[at(face)][at(side)]; }

  // Walks each component and opens the edge to a face that is already oriented the other way.
  void orient_components() {
    component_.assign(mesh_.faces.size(), -1);
    flipped_.assign(mesh_.faces.size(), false);
    for (std::size_t first = 0; first < mesh_.faces.size(); ++first) {
      if (component_[first] >= 0) continue;
      const int id = static_cast<int>(areas_.size());
      areas_.push_back(0.0);
      std::vector<FaceIndex> queue{FaceIndex(first)};
      component_[first] = id;
      for (std::size_t q = 0; q < queue.size(); ++q) {
        const FaceIndex f = queue[q];
        areas_.back() += 0.5 * cross_of(f).norm();
        for (int s = 0; s < 3; ++s) visit_neighbour(f, s, id, queue);
      }
      prefer_majority(queue);
    }
  }

  void visit_neighbour(FaceIndex f, int s, int id, std::vector<FaceIndex>& queue) {
    const FaceIndex n = neighbour_[at(f)][at(s)];
    if (n < 0) return;
    int back = 0;
    while (neighbour_[at(n)][at(back)] != f || !same_edge(f, s, n, back)) {
      if (++back == 3) return;
    }
    const bool agrees = start(f, s) != start(n, back);  // Compares the stored orientation, before any flip.
    const bool wanted = agrees ? flipped_[at(f)] : !flipped_[at(f)];
    if (component_[at(n)] < 0) {
      component_[at(n)] = id;
      flipped_[at(n)] = wanted;
      queue.push_back(n);
    } else if (flipped_[at(n)] != wanted) {
      neighbour_[at(f)][at(s)] = FaceIndex::none();
      neighbour_[at(n)][at(back)] = FaceIndex::none();
      has_unjoined_ = true;
    }
  }
  [[nodiscard]] bool same_edge(FaceIndex f, int s, FaceIndex n, int back) const {
    const auto& a = mesh_.faces[at(f)];
    const auto& b = mesh_.faces[at(n)];
    return std::minmax(a[at(s)], a[at((s + 1) % 3)]) == std::minmax(b[at(back)], b[at((back + 1) % 3)]);
  }

  // The orientation in the file wins if most of the area has it.
  void prefer_majority(const std::vector<FaceIndex>& faces) {
    double turned = 0.0, total = 0.0;
    for (const FaceIndex f : faces) {
      const double area = cross_of(f).norm();
      total += area;
      if (flipped_[at(f)]) turned += area;
    }
    const bool invert = turned > 0.5 * total;
    for (const FaceIndex f : faces) {
      if (invert) flipped_[at(f)] = !flipped_[at(f)];
      report_.flipped_faces += flipped_[at(f)] ? 1 : 0;
    }
  }

  void keep_large_components() {
    keep_.assign(areas_.size(), false);
    for (std::size_t k = 0; k < areas_.size(); ++k) {
      keep_[k] = areas_[k] >= kModuleArea_mm2;
      report_.removed_components += keep_[k] ? 0 : 1;
    }
    report_.components = static_cast<int>(std::ranges::count(keep_, true));
    if (report_.components == 0) {
      throw InputError(
          "surface: no connected part is as large as one module (3.9 cm²); check the mesh and its unit (--unit)");
    }
  }

  // Makes new vertices, one per fan of joined faces, so that no edge has more than two faces and no vertex is pinched.
  void rebuild() {
    std::vector<std::array<int, 3>> vertex(mesh_.faces.size(), {-1, -1, -1});
    if (has_unjoined_) used_edges_.reserve(3 * mesh_.faces.size());
    result_.faces.reserve(mesh_.faces.size());
    result_.vertices.reserve(mesh_.vertices.size());
    for (std::size_t f = 0; f < mesh_.faces.size(); ++f) {
      if (!keep_[at(component_[f])]) {
        ++report_.removed_faces;
        continue;
      }
      for (int k = 0; k < 3; ++k) {
        if (vertex[f][at(k)] < 0) spread(FaceIndex(f), k, vertex);
      }
      std::array<int, 3> face = vertex[f];
      if (flipped_[f]) std::swap(face[1], face[2]);
      add_face(face);
    }
  }

  // Two unjoined faces can still meet at an edge when the fans at both ends connect them elsewhere; the later one is
  // dropped.
  void add_face(const std::array<int, 3>& face) {
    if (!has_unjoined_) {
      result_.faces.push_back(face);
      return;
    }
    const auto edge = [&](std::size_t k) {
      return static_cast<std::uint64_t>(face[k]) << 32U | static_cast<std::uint64_t>(face[(k + 1) % 3]);
    };
    for (std::size_t k = 0; k < 3; ++k) {
      if (used_edges_.contains(edge(k))) {
        ++report_.removed_faces;
        return;
      }
    }
    for (std::size_t k = 0; k < 3; ++k) used_edges_.insert(edge(k));
    result_.faces.push_back(face);
  }

  void spread(FaceIndex face, int k, std::vector<std::array<int, 3>>& vertex) {
    const int old = mesh_.faces[at(face)][at(k)];
    const int id = static_cast<int>(result_.vertices.size());
    result_.vertices.push_back(mesh_.vertices[at(old)]);
    fan_.assign(1, face);
    vertex[at(face)][at(k)] = id;
    for (std::size_t q = 0; q < fan_.size(); ++q) {
      const FaceIndex member = fan_[q];
      const auto& corners = mesh_.faces[at(member)];
      for (int s = 0; s < 3; ++s) {
        if (corners[at(s)] != old && corners[at((s + 1) % 3)] != old) continue;
        const FaceIndex n = neighbour_[at(member)][at(s)];
        if (n < 0) continue;
        for (int c = 0; c < 3; ++c) {
          if (mesh_.faces[at(n)][at(c)] != old || vertex[at(n)][at(c)] >= 0) continue;
          vertex[at(n)][at(c)] = id;
          fan_.push_back(n);
        }
      }
    }
  }

  const Mesh& mesh_;
  std::vector<std::array<FaceIndex, 3>> neighbour_;
  std::vector<int> component_;
  std::vector<bool> flipped_;
  std::vector<double> areas_;
  std::vector<bool> keep_;
  Mesh result_;
  std::vector<FaceIndex> fan_;
  bool has_unjoined_ = false;                     // True if some faces meet at an edge without being neighbours there.
  std::unordered_set<std::uint64_t> used_edges_;  // Each key packs a directed edge, from vertex and to vertex.
  ExtractReport report_;
};

constexpr unsigned kWrap_s = 600;   // This limit is processor time.
constexpr double kShattered = 0.6;  // The input counts as shattered if the largest part has less of the area.
// The repair handles this many faces per second (measured: 44 µs of processor time each).
constexpr double kRepairedFaces = 20'000.0;
constexpr double kMaxReduced_mm = 1.0, kLooseShare = 0.05;  // Small parts may make up this share of the area.

double largest_share(const Mesh& mesh) {
  const Surface surface(mesh);
  std::vector<bool> seen(mesh.faces.size(), false);
  double largest = 0.0;
  for (std::size_t first = 0; first < seen.size(); ++first) {
    if (seen[first]) continue;
    Mesh part{mesh.vertices, {}};
    std::vector<FaceIndex> queue{FaceIndex(first)};
    seen[first] = true;
    for (std::size_t q = 0; q < queue.size(); ++q) {
      part.faces.push_back(mesh.faces[at(queue[q])]);
      for (const FaceIndex n : surface.neighbours(queue[q])) {
        if (n < 0 || seen[at(n)]) continue;
        seen[at(n)] = true;
        queue.push_back(n);
      }
    }
    largest = std::max(largest, area_of(part));
  }
  return largest / area_of(mesh);
}

// The counts of the earlier steps stay in the report.
void repair_again(Extraction& e, const Mesh& mesh, const char* step) {
  if (mesh.faces.empty()) throw InputError(fmt::format("surface: {} leaves nothing", step));
  const ExtractReport before = e.report;
  e = Extractor(mesh).run();
  e.report.removed_components += before.removed_components;
  e.report.removed_faces += before.removed_faces;
  e.report.flipped_faces += before.flipped_faces;
  e.report.non_manifold_edges = before.non_manifold_edges;
  e.report.outer = before.outer;
  e.report.wrapped = before.wrapped;
  e.report.repair = before.repair;
  e.report.crossings = before.crossings;
  e.report.deviation = before.deviation;
}

bool messy(const ExtractReport& r) {
  return r.components > 1 || r.non_manifold_edges > 0;
}

void drop_hidden(Extraction& e, const ExtractOptions& options, const ProgressSink& progress) {
  report(progress, "looking for the outside", 0.3);
  const std::size_t before = e.surface.faces.size();
  e.report.outer = true;
  repair_again(e, outer_faces(e.surface, options.visibility_fraction, kVisibilityTimeShare * options.repair_s),
               "dropping the faces that see little of the sky");
  e.report.removed_faces += static_cast<int>(before - e.surface.faces.size());
}

// Takes the requested steps as they are; the result may be one that design() refuses.
Extraction stepwise(const Mesh& mesh, const ExtractOptions& options, const ProgressSink& progress) {
  using When = ExtractOptions::When;
  Extraction e = repair_topology(mesh);
  const bool was_messy = messy(e.report);
  if (options.outer == When::kAlways || (options.outer == When::kWhenNeeded && was_messy))
    drop_hidden(e, options, progress);
  const bool bad = options.wrap == When::kWhenNeeded && was_messy &&
                   (largest_share(e.surface) < kShattered || crosses_itself(e.surface));
  if (options.wrap != When::kAlways && !bad) return e;
  report(progress, "wrapping", 0.6);
  const auto wrap = wrapped(mesh, options.wrap_alpha_mm, options.wrap_offset_mm, kWrap_s, {});
  if (!wrap)
    throw InputError(fmt::format("surface: the wrap takes longer than {} s; give a larger --wrap-alpha-mm", kWrap_s));
  e.report.wrapped = true;
  repair_again(e, *wrap, "wrapping");
  if (options.outer != When::kNever) drop_hidden(e, options, progress);
  return e;
}

// Takes the requested steps if they lead to a surface that design() accepts, and repairs otherwise.
Extraction stepwise_or_repaired(const Mesh& mesh, const ExtractOptions& options, const RepairTime& time,
                                const ProgressSink& progress) {
  ExtractOptions first = options;
  if (first.wrap == ExtractOptions::When::kWhenNeeded) first.wrap = ExtractOptions::When::kNever;
  try {
    Extraction e = stepwise(mesh, first, progress);
    const bool shattered = messy(e.report) && e.report.outer && largest_share(e.surface) < kShattered;
    if (!shattered && usable(e.surface)) return e;
  } catch (const InputError&) {
    // Nothing remains after the steps alone.
  }
  return repaired(mesh, options, time, progress);
}

// Decimates a mesh if its joined part has more faces than the repair has time for. Returns nothing if it has not, or if
// too much would be missing.
std::optional<DecimatedMesh> decimated(const Mesh& mesh, const std::optional<Extraction>& joined, std::size_t most) {
  if (!joined || joined->surface.faces.size() <= most || area_of(joined->surface) < (1.0 - kLooseShare) * area_of(mesh))
    return std::nullopt;
  return decimate(Surface(joined->surface), kMaxReduced_mm, kMaxReduced_mm, all_threads(), most);
}

// Copies into the report of a repair what is known about the mesh with which it began.
void add_reduction(ExtractReport& report, const ExtractReport& before, const DecimatedMesh& reduction) {
  report.reduced_mm = std::max(reduction.deviation_mm, reduction.border_mm);
  report.deviation.largest_mm += report.reduced_mm;
  report.deviation.mean_mm += report.reduced_mm;
  report.removed_components += before.removed_components;
  report.flipped_faces += before.flipped_faces;
  report.non_manifold_edges = before.non_manifold_edges;
}

void require_area_of_module(const Mesh& mesh) {
  if (const double area_mm2 = area_of(mesh); area_mm2 < kModuleArea_mm2)
    throw InputError(fmt::format("surface: {:.2g} cm², less than one module (3.9 cm²); check mesh and unit (--unit)",
                                 area_mm2 / 100.0));
}

void drop_enclosed_parts(Extraction& e) {
  e.report.enclosed_components = drop_enclosed(e.surface);
  e.report.components -= e.report.enclosed_components;
}

Extraction chosen(const Mesh& mesh, const ExtractOptions& options, const ProgressSink& progress) {
  const RepairTime time(options);
  // A wrap has both sides of a sheet, so it would make a sheet that is too small large enough.
  require_area_of_module(mesh);
  const auto most = static_cast<std::size_t>(kRepairedFaces * options.repair_s);
  UsableTest test;
  // A fault is usually found soon; if there is none, the repair needs no time.
  if (options.keep_usable || mesh.faces.size() > most) test = test_usable(mesh, time.part(1.0));
  if (test.is_usable && options.keep_usable) return std::move(*test.joined);
  const auto reduction = test.is_usable ? std::nullopt : decimated(mesh, test.joined, most);
  if (!reduction) return stepwise_or_repaired(mesh, options, time, progress);
  Extraction e = stepwise_or_repaired(reduction->mesh, options, time, progress);
  add_reduction(e.report, test.joined->report, *reduction);
  return e;
}

}  // namespace

Extraction repair_topology(const Mesh& mesh) {
  return Extractor(mesh).run();
}

Extraction extract(const Mesh& mesh, const ProgressSink& progress) {
  report(progress, "extracting", 0.0);
  return repair_topology(mesh);
}

Extraction extract(const Mesh& mesh, const ExtractOptions& options, const ProgressSink& progress) {
  report(progress, "extracting", 0.0);
  Extraction e = options.repair ? chosen(mesh, options, progress) : stepwise(mesh, options, progress);
  if (!options.spheres.empty() || !options.boxes.empty() || options.keep_out) {
    report(progress, "keeping out", 0.9);
    const double before_mm2 = area_of(e.surface);
    const Mesh kept = without_keep_outs(e.surface, options);
    repair_again(e, kept, "taking the keep-outs away");
    if (options.repair && !usable(e.surface))
      e.surface = remove_crossings(e.surface, kVisibilityTimeShare * options.repair_s).surface;
    e.report.kept_out_mm2 = before_mm2 - area_of(e.surface);
  }
  if (options.repair && options.outer != ExtractOptions::When::kNever) drop_enclosed_parts(e);
  if (options.repair) e.report.flipped_faces += turn_outward(e.surface);
  e.report.boundary_loops = boundary_loops_of(e.surface);
  return e;
}

}  // namespace triskin::mesh
