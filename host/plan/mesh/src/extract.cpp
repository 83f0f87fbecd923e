// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mesh/extract.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <span>
#include <unordered_set>

#include "dropped_parts.hpp"
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

// Joins faces over their edges, orients each part over them and rebuilds the vertices from the fans of joined faces.
class Joiner {
 public:
  Joiner(const Mesh& mesh, SmallParts small_parts, ExtractReport& report)
      : mesh_(mesh), small_parts_(small_parts), report_(report) {}

  Mesh run() {
    pair_faces();
    orient_components();
    choose_components();
    rebuild();
    if (std::ranges::count(is_dropped_, true) > 0) {
      const std::vector<DroppedPart> dropped = parts_of_faces(mesh_, is_dropped_);
      report_.dropped.insert(report_.dropped.end(), dropped.begin(), dropped.end());
    }
    return std::move(result_);
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

  void choose_components() {
    keep_.assign(areas_.size(), true);
    for (std::size_t k = 0; k < areas_.size() && small_parts_ == SmallParts::kDropped; ++k) {
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
    is_dropped_.assign(mesh_.faces.size(), false);
    for (std::size_t f = 0; f < mesh_.faces.size(); ++f) {
      if (!keep_[at(component_[f])]) {
        drop(f);
        continue;
      }
      for (int k = 0; k < 3; ++k) {
        if (vertex[f][at(k)] < 0) spread(FaceIndex(f), k, vertex);
      }
      std::array<int, 3> face = vertex[f];
      if (flipped_[f]) std::swap(face[1], face[2]);
      if (!has_unjoined_ || is_free(face))
        result_.faces.push_back(face);
      else if (small_parts_ == SmallParts::kDropped)
        drop(f);
      else
        add_alone(face);
    }
  }

  void drop(std::size_t face) {
    is_dropped_[face] = true;
    ++report_.removed_faces;
  }

  // Two unjoined faces can still meet at an edge when the fans at both ends connect them elsewhere; then only the first
  // has it. Takes the edges of a face that is free.
  [[nodiscard]] bool is_free(const std::array<int, 3>& face) {
    const auto edge = [&](std::size_t k) {
      return static_cast<std::uint64_t>(face[k]) << 32U | static_cast<std::uint64_t>(face[(k + 1) % 3]);
    };
    for (std::size_t k = 0; k < 3; ++k) {
      if (used_edges_.contains(edge(k))) return false;
    }
    for (std::size_t k = 0; k < 3; ++k) used_edges_.insert(edge(k));
    return true;
  }

  void add_alone(const std::array<int, 3>& face) {
    const int first = static_cast<int>(result_.vertices.size());
    for (const int v : face) result_.vertices.push_back(Vec3(result_.vertices[at(v)]));
    result_.faces.push_back({first, first + 1, first + 2});
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
  std::vector<bool> is_dropped_;
  SmallParts small_parts_;
  ExtractReport& report_;
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

bool messy(const ExtractReport& r) {
  return r.components > 1 || r.non_manifold_edges > 0;
}

void require_faces(const Mesh& mesh, const char* step) {
  if (mesh.faces.empty()) throw InputError(fmt::format("surface: {} leaves nothing", step));
}

void require_area_of_module(const Mesh& mesh) {
  if (const double area_mm2 = area_of(mesh); area_mm2 < kModuleArea_mm2)
    throw InputError(fmt::format("surface: {:.2g} cm², less than one module (3.9 cm²); check mesh and unit (--unit)",
                                 area_mm2 / 100.0));
}

Mesh without_hidden(const Mesh& mesh, const ExtractOptions& options, ExtractReport& r, const ProgressSink& progress) {
  report(progress, "looking for the outside", 0.3);
  r.outer = true;
  const Mesh seen = outer_faces(mesh, options.visibility_fraction, kVisibilityTimeShare * options.repair_s);
  require_faces(seen, "dropping the faces that see little of the sky");
  name_dropped(mesh, seen, r.dropped);
  r.removed_faces += static_cast<int>(mesh.faces.size() - seen.faces.size());
  return joined(seen, r);
}

// Takes the steps that are asked for as they are; the result may be one that design() refuses.
Mesh with_steps(const Mesh& mesh, const ExtractOptions& options, ExtractReport& r, const ProgressSink& progress) {
  using When = ExtractOptions::When;
  Mesh surface = joined(mesh, r);
  const bool was_messy = messy(r);
  if (options.outer == When::kAlways || (options.outer == When::kWhenNeeded && was_messy))
    surface = without_hidden(surface, options, r, progress);
  const bool bad = options.wrap == When::kWhenNeeded && was_messy &&
                   (largest_share(surface) < kShattered || crosses_itself(surface));
  if (options.wrap != When::kAlways && !bad) return surface;
  report(progress, "wrapping", 0.6);
  const auto wrap = wrapped(mesh, options.wrap_alpha_mm, options.wrap_offset_mm, kWrap_s, {});
  if (!wrap)
    throw InputError(fmt::format("surface: the wrap takes longer than {} s; give a larger --wrap-alpha-mm", kWrap_s));
  require_faces(*wrap, "wrapping");
  r.wrapped = true;
  surface = joined(*wrap, r);
  return options.outer == When::kNever ? surface : without_hidden(surface, options, r, progress);
}

// Decimates the joined part of a mesh if it has more faces than the repair has time for. Returns nothing if it has not,
// or if too much would be missing.
std::optional<DecimatedMesh> decimated(const Mesh& mesh, const std::optional<Mesh>& joined, std::size_t max_faces) {
  if (!joined || joined->faces.size() <= max_faces || area_of(*joined) < (1.0 - kLooseShare) * area_of(mesh))
    return std::nullopt;
  return decimate(Surface(*joined), kMaxReduced_mm, kMaxReduced_mm, all_threads(), max_faces);
}

// Makes what design() accepts: the joined mesh, or else the result of the steps that are asked for, or else a repair. A
// mesh that is not accepted and has too many faces for the time is reduced before.
Mesh made_usable(const Mesh& mesh, const ExtractOptions& options, ExtractReport& r, const ProgressSink& progress) {
  const RepairTime time(options);
  // A wrap has both sides of a sheet, so it would make a sheet that is too small large enough.
  require_area_of_module(mesh);
  const auto max_faces = static_cast<std::size_t>(kRepairedFaces * options.repair_s);
  std::optional<DecimatedMesh> reduction;
  // A fault is usually found soon; if there is none, the repair needs no time.
  if (options.keep_usable || mesh.faces.size() > max_faces) {
    ExtractReport tried = r;
    UsableTest test = test_usable(mesh, tried, time.part(1.0));
    if (!test.is_usable) reduction = decimated(mesh, test.joined, max_faces);
    if (reduction) tried.reduced_mm = std::max(reduction->deviation_mm, reduction->border_mm);
    if (reduction || (test.is_usable && options.keep_usable)) r = tried;
    if (test.is_usable && options.keep_usable) return std::move(*test.joined);
  }
  const Mesh& start = reduction ? reduction->mesh : mesh;
  ExtractOptions steps = options;
  if (steps.wrap == ExtractOptions::When::kWhenNeeded) steps.wrap = ExtractOptions::When::kNever;
  ExtractReport tried = r;
  try {
    Mesh surface = with_steps(start, steps, tried, progress);
    const bool shattered = messy(tried) && tried.outer && largest_share(surface) < kShattered;
    if (!shattered && usable(surface)) {
      r = tried;
      return surface;
    }
  } catch (const InputError&) {
    // Nothing remains after the steps alone.
  }
  return repaired(start, options, time, r, progress);
}

}  // namespace

Mesh joined(const Mesh& mesh, ExtractReport& report, SmallParts small_parts) {
  return Joiner(mesh, small_parts, report).run();
}

Extraction extract(const Mesh& mesh, const ProgressSink& progress) {
  return extract(mesh, ExtractOptions{}, progress);
}

Extraction extract(const Mesh& mesh, const ExtractOptions& options, const ProgressSink& progress) {
  report(progress, "extracting", 0.0);
  Extraction e;
  ExtractReport& r = e.report;
  r.non_manifold_edges = non_manifold_edges_of(mesh);
  e.surface = options.repair ? made_usable(mesh, options, r, progress) : with_steps(mesh, options, r, progress);
  r.deviation.largest_mm += r.reduced_mm;
  r.deviation.mean_mm += r.reduced_mm;
  if (!options.spheres.empty() || !options.boxes.empty() || options.keep_out) {
    report(progress, "keeping out", 0.9);
    const double before_mm2 = area_of(e.surface);
    const Mesh kept = without_keep_outs(e.surface, options);
    require_faces(kept, "taking the keep-outs away");
    e.surface = joined(kept, r);
    if (options.repair && !usable(e.surface))
      e.surface = remove_crossings(e.surface, kVisibilityTimeShare * options.repair_s, r);
    r.kept_out_mm2 = before_mm2 - area_of(e.surface);
  }
  if (options.repair && options.outer != ExtractOptions::When::kNever) {
    const Mesh before = e.surface;
    r.enclosed_components = drop_enclosed(e.surface);
    r.components -= r.enclosed_components;
    if (r.enclosed_components > 0) name_dropped(before, e.surface, r.dropped);
  }
  if (options.repair) r.flipped_faces += turn_outward(e.surface);
  r.boundary_loops = boundary_loops_of(e.surface);
  return e;
}

}  // namespace triskin::mesh
