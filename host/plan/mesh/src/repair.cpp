// SPDX-License-Identifier: GPL-3.0-or-later
// Turns any triangles into a surface that design() accepts. The methods are tried in turn, and the last one always
// gives a result.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <map>
#include <numeric>
#include <span>

#include "clean.hpp"
#include "crossing_search.hpp"
#include "dropped_parts.hpp"
#include "edge_sides.hpp"
#include "isolated.hpp"
#include "polygon_faces.hpp"
#include "triangle_tree.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/index.hpp"
#include "triskin/mesh/extract_steps.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::mesh {
namespace {

constexpr double kApart_mm = 0.01;          // Corners that would only touch are moved apart by this distance.
constexpr int kRoundsApart = 5;             // Corners are moved at most this often; parts that still touch are dropped.
constexpr int kRoundsDivided = 3;           // Dividing is repeated because rounded coordinates may cross again.
constexpr double kHiddenVisibility = 0.05;  // A part of the arrangement that sees less of the sky counts as inside.
constexpr std::size_t kVisibilitySamples = 48;  // This many faces of a part are sampled.
// Small parts are dropped by name up to this fraction of the area; with more the input counts as shattered, and a
// surface that leaves them out is as far from it as they are.
constexpr double kLooseShare = 0.1;
constexpr double kGoodDeviation_mm = 5.0, kGoodMean_mm = 0.2;  // Below both values the next method is not tried.
// The width is the area of a border loop over its length: a hole of 0.4 mm across has this value.
constexpr double kSlitWidth_mm = 0.1;
constexpr std::size_t kMaxSlitCorners = 60, kMaxSlits = 10;
constexpr double kGridNodes = 1.5e6;
constexpr double kGridCost_s = 1e-4;  // This time was measured for each cell² of the area, including all later steps.
constexpr double kMinCell_mm = 1.0;
// Each step may take at most this fraction of the time; they add up to more than 1, since few meshes need all of them.
// The fraction for dividing, on which the others depend, is processor time: on a busy machine it may take all the time.
constexpr double kDivideShare = 0.4, kWrapShare = 0.4, kNearShare = 0.15, kSettleShare = 0.25, kMeasureShare = 0.12;
constexpr double kMinGridShare = 0.2;
constexpr double kNeedle = 1e-5;  // The ratio is twice the area over the square of the longest side.
constexpr int kRoundsNear = 6;    // The surface of a grid is moved toward the input this often.
// The cost is processor time for each alpha² of the area; 0.1e-3 … 1.1e-3 were measured.
constexpr double kWrapCost_s = 1.2e-3;
constexpr double kWelding = 1e-6;  // Welding moves vertices by this share of the size, over all steps.

using Pairs = std::vector<FacePair>;

bool late(const IsLate& is_late) {
  return is_late && is_late();
}

double area_of_face(const Mesh& mesh, FaceIndex face) {
  const auto& f = mesh.faces[at(face)];
  const Vec3 &a = mesh.vertices[at(f[0])], &b = mesh.vertices[at(f[1])], &c = mesh.vertices[at(f[2])];
  return 0.5 * (b - a).cross(c - a).norm();
}

bool changed_by_cleaning(const Mesh& mesh) {
  Mesh copy = mesh;
  MeshReadReport changes;
  clean(copy, changes);
  return changes.welded_vertices + changes.joined_corners + changes.degenerate_faces + changes.duplicate_faces > 0;
}

std::vector<bool> border_vertices(const Mesh& mesh) {
  std::vector<bool> border(mesh.vertices.size(), false);
  const EdgeSides sides(mesh);
  sides.each_edge([&](std::span<const EdgeSide> edge) {
    if (edge.size() == 1) border[at(edge[0].low)] = border[at(edge[0].high)] = true;
  });
  return border;
}

// Moves vertices at the same place a little towards their own faces: those at a border, or else all of them.
void draw_apart(Mesh& mesh) {
  const auto place = [&](VertexIndex v) {
    const Vec3& p = mesh.vertices[at(v)];
    return std::array<double, 3>{p.x(), p.y(), p.z()};
  };
  std::vector<VertexIndex> by_place(mesh.vertices.size());
  std::iota(by_place.begin(), by_place.end(), VertexIndex{0});
  std::ranges::sort(by_place, {}, place);
  std::vector<bool> moves(mesh.vertices.size(), false);
  const std::vector<bool> border = border_vertices(mesh);
  for (std::size_t first = 0, end = 0; first < by_place.size(); first = end) {
    while (end < by_place.size() && place(by_place[end]) == place(by_place[first])) ++end;
    const auto vertices = std::span(by_place).subspan(first, end - first);
    if (vertices.size() < 2) continue;
    const auto at_border = std::ranges::count_if(vertices, [&](VertexIndex v) { return border[at(v)]; });
    for (const VertexIndex v : vertices) moves[at(v)] = at_border == 0 || border[at(v)];
  }
  std::vector<Vec3> sum(mesh.vertices.size(), Vec3::Zero());
  std::vector<int> count(mesh.vertices.size(), 0);
  for (const auto& f : mesh.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      sum[at(f[k])] += mesh.vertices[at(f[(k + 1) % 3])] + mesh.vertices[at(f[(k + 2) % 3])];
      count[at(f[k])] += 2;
    }
  }
  const double step_mm = std::max(kApart_mm, 4e-7 * diagonal_of(mesh));
  for (std::size_t v = 0; v < moves.size(); ++v) {
    if (!moves[v] || count[v] == 0) continue;
    const Vec3 way = sum[v] / count[v] - mesh.vertices[v];
    if (way.norm() > 0.0) mesh.vertices[v] += std::min(step_mm / way.norm(), 0.25) * way;
  }
}

// Returns border loops that are too narrow to be intended, each oriented for the faces that would fill it.
std::vector<std::vector<VertexIndex>> slits_of(const Mesh& mesh) {
  std::vector<std::vector<VertexIndex>> slits;
  const Surface surface(mesh);
  for (std::vector<VertexIndex> loop : surface.border_loops()) {
    if (loop.size() < 3 || loop.size() > kMaxSlitCorners) continue;
    Vec3 twice = Vec3::Zero();
    double around_mm = 0.0;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec3 &a = mesh.vertices[at(loop[k])], &b = mesh.vertices[at(loop[(k + 1) % loop.size()])];
      twice += (a - mesh.vertices[at(loop[0])]).cross(b - mesh.vertices[at(loop[0])]);
      around_mm += (b - a).norm();
    }
    if (0.5 * twice.norm() > kSlitWidth_mm * around_mm) continue;
    std::ranges::reverse(loop);
    slits.push_back(std::move(loop));
  }
  return slits;
}

// Closes the slits that dropped faces leave: all of them, or else, unless late, one by one those that cause no
// crossing.
void close_slits(Mesh& mesh, const IsLate& is_late) {
  const auto slits = slits_of(mesh);
  const auto closed = [](Mesh m, const std::vector<VertexIndex>& slit) {
    add_polygon(m, slit);
    return m;
  };
  Mesh all = mesh;
  for (const auto& slit : slits) all = closed(std::move(all), slit);
  if (slits.empty() || usable(all)) {
    mesh = std::move(all);
    return;
  }
  for (std::size_t k = 0; k < std::min(slits.size(), kMaxSlits) && !late(is_late); ++k) {
    Mesh one = closed(mesh, slits[k]);
    if (usable(one)) mesh = std::move(one);
  }
}

// Tells whether the face is lower than corners are moved apart: what it covers, its neighbours nearly cover too.
bool is_thin(const Mesh& mesh, FaceIndex face) {
  const geometry::Triangle t = triangle_of(mesh, face);
  const double longest = std::max({(t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm()});
  return 2.0 * geometry::area_of(t) < kApart_mm * longest;
}

// Values the two faces of a crossing: the one with less visibility is dropped, or if that is not measured, the smaller
// one; but always a thin one rather than its neighbour.
std::map<FaceIndex, double> values_of(const Mesh& mesh, const Pairs& crossings, double visibility_s, bool is_late) {
  std::vector<FaceIndex> asked;
  for (const auto& [a, b] : crossings) asked.insert(asked.end(), {a, b});
  std::ranges::sort(asked);
  asked.erase(std::ranges::unique(asked).begin(), asked.end());
  const bool asks_visibility = !is_late && asked.size() <= faces_asked_in(visibility_s);
  const std::vector<Visibility> visibility = asks_visibility ? visibility_of(mesh, asked) : std::vector<Visibility>{};
  std::map<FaceIndex, double> value;
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const double worth =
        asks_visibility ? std::max(visibility[k].front, visibility[k].back) : area_of_face(mesh, asked[k]);
    value[asked[k]] = is_thin(mesh, asked[k]) ? -1.0 : worth;
  }
  return value;
}

// Removes the less valuable face of each crossing pair.
Mesh without_crossings(const Mesh& mesh, const Pairs& crossings, double visibility_s, bool is_late) {
  const std::map<FaceIndex, double> value = values_of(mesh, crossings, visibility_s, is_late);
  std::vector<bool> gone(mesh.faces.size(), false);
  for (const auto& [a, b] : crossings) {
    if (!gone[at(a)] && !gone[at(b)]) gone[at(value.at(a) < value.at(b) ? a : b)] = true;
  }
  Mesh result{mesh.vertices, {}};
  for (std::size_t f = 0; f < gone.size(); ++f) {
    if (!gone[f]) result.faces.push_back(mesh.faces[f]);
  }
  return result;
}

// Divides crossing faces in a child process, because exact constructions may take long. A round that begins late could
// lose the result of those before it.
std::optional<Mesh> divided(const Mesh& mesh, const RepairTime& time) {
  const double half_s = 0.5 * time.cpu_s(kDivideShare);
  // Returns the processor time of the child.
  const auto used_s = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  const auto work = [&] {
    Mesh m = mesh;
    for (int round = 0; round < kRoundsDivided && (round == 0 || used_s() < half_s); ++round) {
      ExtractReport unused;
      const Mesh whole = joined(m, unused, SmallParts::kKept);
      const Pairs crossings = crossing_faces(whole, 1);
      if (crossings.empty()) break;
      Mesh next = arranged(whole, crossings);
      MeshReadReport changes;
      clean(next, changes);
      const bool same = next.vertices.size() == m.vertices.size() && next.faces.size() == m.faces.size();
      m = std::move(next);
      if (same) break;
    }
    return bytes_of(m);
  };
  const auto answer = run_isolated(
      [&]() -> std::string {
        try {
          return work();
        } catch (const InputError&) {
          return {};
        }
      },
      {.cpu_s = time.cpu_s(kDivideShare)}, time.part(1.0));
  if (!answer || answer->empty()) return std::nullopt;
  return mesh_of(*answer);
}

// Returns the parts that are connected over edges of two faces.
std::vector<std::vector<FaceIndex>> parts_of(const Mesh& mesh) {
  constexpr FaceIndex kNone = FaceIndex::none();
  std::vector<std::array<FaceIndex, 3>> neighbour(mesh.faces.size(), {kNone, kNone, kNone});
  const EdgeSides sides(mesh);
  sides.each_edge([&](std::span<const EdgeSide> edge) {
    if (edge.size() != 2) return;
    neighbour[at(edge[0].face)][at(edge[0].side)] = edge[1].face;
    neighbour[at(edge[1].face)][at(edge[1].side)] = edge[0].face;
  });
  std::vector<bool> seen(mesh.faces.size(), false);
  std::vector<std::vector<FaceIndex>> parts;
  for (std::size_t first = 0; first < seen.size(); ++first) {
    if (seen[first]) continue;
    std::vector<FaceIndex> part{FaceIndex(first)};
    seen[first] = true;
    for (std::size_t q = 0; q < part.size(); ++q) {
      for (const FaceIndex n : neighbour[at(part[q])]) {
        if (n < 0 || seen[at(n)]) continue;
        seen[at(n)] = true;
        part.push_back(n);
      }
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

// Returns the largest faces of a part, which represent it when visibility is measured.
std::vector<FaceIndex> samples_of(const Mesh& mesh, std::vector<FaceIndex> part, std::size_t most) {
  const std::size_t n = std::min(part.size(), most);
  std::ranges::partial_sort(part, part.begin() + static_cast<std::ptrdiff_t>(n), std::greater<>(),
                            [&](FaceIndex f) { return std::pair(area_of_face(mesh, f), f); });
  part.resize(n);
  return part;
}

// Parts whose better side sees next to nothing, in the mean over their samples, are inside. If there are many parts,
// each has fewer samples; if even one sample per part exceeds `visibility_s`, only the parts with most faces are
// tested.
Mesh without_hidden_parts(const Mesh& mesh, double visibility_s) {
  auto parts = parts_of(mesh);
  if (parts.size() < 2) return mesh;
  std::ranges::stable_sort(parts, std::greater<>(), [](const auto& part) { return part.size(); });
  const std::size_t most = faces_asked_in(visibility_s);
  const auto asked_of = [&](std::size_t each) {
    return std::accumulate(parts.begin(), parts.end(), std::size_t{0},
                           [each](std::size_t sum, const auto& part) { return sum + std::min(part.size(), each); });
  };
  std::size_t each = kVisibilitySamples;
  while (each > 1 && asked_of(each) > most) each /= 2;
  std::vector<FaceIndex> asked;
  std::vector<std::size_t> first;
  for (const auto& part : parts) {
    first.push_back(asked.size());
    const auto samples = samples_of(mesh, part, asked.size() < most ? each : 0);
    asked.insert(asked.end(), samples.begin(), samples.end());
  }
  first.push_back(asked.size());
  const std::vector<Visibility> visibility = visibility_of(mesh, asked);
  Mesh result{mesh.vertices, {}};
  for (std::size_t p = 0; p < parts.size(); ++p) {
    double sum = 0.0, total = 0.0;
    for (std::size_t k = first[p]; k < first[p + 1]; ++k) {
      const double area = area_of_face(mesh, asked[k]);
      sum += area * std::max(visibility[k].front, visibility[k].back);
      total += area;
    }
    if (sum < kHiddenVisibility * total) continue;  // A part without samples is kept.
    for (const FaceIndex f : parts[p]) result.faces.push_back(mesh.faces[at(f)]);
  }
  return result.faces.empty() ? mesh : result;
}

// The deviation is measured from this mesh; the flags mark its outside faces.
struct Reference {
  Mesh mesh;
  std::vector<bool> outside;
};

Reference reference_of(Mesh mesh, double visibility_fraction, double cpu_s) {
  Reference r{std::move(mesh), {}};
  for (const Visibility& s : visibility_of_all(r.mesh, cpu_s))
    r.outside.push_back(std::max(s.front, s.back) >= visibility_fraction);
  return r;
}

bool is_needle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return (b - a).cross(c - a).norm() < kNeedle * longest;
}

// Returns faces that cross, or have almost no area.
std::vector<FaceIndex> bad_faces(const Mesh& mesh) {
  std::vector<FaceIndex> bad;
  for (const auto& [a, b] : crossing_faces(mesh)) bad.insert(bad.end(), {a, b});
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto& c = mesh.faces[f];
    if (is_needle(mesh.vertices[at(c[0])], mesh.vertices[at(c[1])], mesh.vertices[at(c[2])]))
      bad.push_back(FaceIndex(f));
  }
  return bad;
}

// Moves the corners of a wrap up to the gap to the input; those of faces that would cross stop on the way or stay. A
// wrap that does not cross itself stays free of crossings; when late it stays unchanged.
Mesh drawn_near(const Mesh& wrap, const Mesh& input, double gap_mm, const IsLate& is_late) {
  const TriangleTree surface(input);
  std::vector<Vec3> way(wrap.vertices.size());
  tbb::parallel_for(std::size_t{0}, way.size(), [&](std::size_t v) {
    const SurfacePoint p = surface.closest(wrap.vertices[v]);
    const double share = p.distance_mm > gap_mm ? 1.0 - gap_mm / p.distance_mm : 0.0;
    way[v] = share * (p.position_mm - wrap.vertices[v]);
  });
  std::vector<double> part(way.size(), 1.0);
  Mesh result = wrap;
  for (int round = 0; round < kRoundsNear && !late(is_late); ++round) {
    for (std::size_t v = 0; v < way.size(); ++v) result.vertices[v] = wrap.vertices[v] + part[v] * way[v];
    const std::vector<FaceIndex> bad = bad_faces(result);
    if (bad.empty()) return result;
    std::vector<bool> back(way.size(), false);
    for (const FaceIndex f : bad) {
      for (const int v : wrap.faces[at(f)]) back[at(v)] = true;
    }
    for (std::size_t v = 0; v < back.size(); ++v) {
      if (back[v]) part[v] = part[v] > 0.3 ? 0.5 * part[v] : 0.0;
    }
  }
  return wrap;
}

class Repairer {
 public:
  Repairer(const Mesh& mesh, const ExtractOptions& options, const RepairTime& time, const ExtractReport& before,
           const ProgressSink& progress)
      : mesh_(mesh), options_(options), time_(time), progress_(progress), before_(before) {}

  Mesh run(ExtractReport& report) {
    local();
    if (options_.wrap != ExtractOptions::When::kNever) {
      if (!good()) wrap(options_.wrap_alpha_mm);
      if (!good()) grid();
    }
    if (!best_)
      throw InputError("surface: no part as large as one module (3.9 cm²); check the mesh and its unit (--unit)");
    report = std::move(best_->report);
    const auto hidden = parts_beyond(reference_.mesh, reference_.outside, best_->surface, report.deviation.largest_mm);
    report.dropped.insert(report.dropped.end(), hidden.begin(), hidden.end());
    return std::move(best_->surface);
  }

 private:
  // A wrap changes all faces, which is worth it only if much is missing.
  [[nodiscard]] bool good() const {
    if (!best_) return false;
    const Deviation& d = best_->report.deviation;
    return d.largest_mm <= kGoodDeviation_mm || d.mean_mm <= kGoodMean_mm;
  }
  [[nodiscard]] double visibility_s() const { return kVisibilityTimeShare * options_.repair_s; }

  void local() {
    report(progress_, "dividing faces that cross", 0.1);
    ExtractReport all = before_;
    Mesh input = joined(mesh_, all, SmallParts::kKept);
    try {
      Mesh large = joined(mesh_, before_);
      if (area_of(large) >= (1.0 - kLooseShare) * area_of(mesh_))
        input = std::move(large);
      else
        before_ = std::move(all);  // Too much is loose to be dropped by name: all of the input counts.
    } catch (const InputError&) {
      before_ = std::move(all);  // The input is shattered, so only the wraps help.
    }
    before_.crossings = static_cast<int>(crossing_faces(input).size());
    const auto parts = divided(input, time_);
    reference_ = reference_of(parts ? *parts : input, options_.visibility_fraction, visibility_s());
    try_settling(without_hidden_parts(reference_.mesh, visibility_s()), Repair::kLocal,
                 options_.outer == ExtractOptions::When::kAlways);
  }

  // The steps after a wrap take as long as the wrap itself; the remaining time must hold both.
  void wrap(double alpha_mm) {
    const double max_s = std::min(kWrapShare * options_.repair_s, 0.5 * time_.left_s());
    if (kWrapCost_s * area_of(reference_.mesh) / (alpha_mm * alpha_mm) > max_s) return;
    report(progress_, "wrapping", 0.5);
    const auto mesh =
        wrapped(reference_.mesh, alpha_mm, options_.wrap_offset_mm, time_.cpu_s(kWrapShare), time_.part(kWrapShare));
    if (mesh) try_settling(*mesh, Repair::kWrap, options_.outer != ExtractOptions::When::kNever);
  }

  // Makes the grid as fine as the remaining time allows. A repair without any result yet takes a little more.
  void grid() {
    const double min_s = best_ ? 0.0 : kMinGridShare * options_.repair_s;
    const double left_s = std::max(min_s, time_.left_s());
    if (best_ && left_s < kMinGridShare * options_.repair_s) return;
    report(progress_, "wrapping on a grid", 0.8);
    Eigen::AlignedBox3d box;
    for (const Vec3& v : reference_.mesh.vertices) box.extend(v);
    const double least = 0.02 * box.sizes().maxCoeff();
    const double volume = box.sizes().cwiseMax(least).prod();
    const double cell_mm = std::max(
        {kMinCell_mm, std::cbrt(volume / kGridNodes), std::sqrt(kGridCost_s * area_of(reference_.mesh) / left_s)});
    const Mesh wrap = grid_wrapped(reference_.mesh, cell_mm);
    try_settling(drawn_near(wrap, reference_.mesh, options_.wrap_offset_mm, time_.part(kNearShare)), Repair::kGrid,
                 false);
  }

  void try_settling(const Mesh& mesh, Repair way, bool outer) {
    try {
      report(progress_, "settling the repair", -1.0);
      Extraction e{{}, before_};
      ExtractReport& r = e.report;
      r.outer = outer;
      r.wrapped = way != Repair::kLocal;
      r.repair = way;
      const Mesh seen = outer ? outer_faces(joined(mesh, r), options_.visibility_fraction, visibility_s()) : mesh;
      e.surface = remove_crossings(seen, visibility_s(), r, time_.part(kSettleShare));
      r.dropped = before_.dropped;  // The deviation counts all that was dropped since.
      report(progress_, "measuring the repair", 0.9);
      r.deviation = deviation_between(reference_.mesh, reference_.outside, e.surface, time_.part(kMeasureShare));
      r.deviation.largest_mm += kWelding * diagonal_of(mesh_);
      if (way == Repair::kLocal) {
        const auto missing = missing_parts(reference_.mesh, reference_.outside, e.surface, 2.0 * kApart_mm);
        r.dropped.insert(r.dropped.end(), missing.begin(), missing.end());
      }
      if (!best_ || r.deviation.largest_mm < best_->report.deviation.largest_mm) best_ = std::move(e);
    } catch (const InputError&) {
      // This method left nothing large enough, so the next one is tried.
    }
  }

  const Mesh& mesh_;
  const ExtractOptions& options_;
  const RepairTime& time_;
  const ProgressSink& progress_;
  Reference reference_;
  ExtractReport before_;  // What every way begins with.
  std::optional<Extraction> best_;
};

}  // namespace

UsableTest test_usable(const Mesh& mesh, ExtractReport& report, const IsLate& is_late) {
  UsableTest test;
  if (mesh.faces.empty()) return test;
  try {
    test.joined = joined(mesh, report);
  } catch (const InputError&) {
    return test;
  }
  if (non_manifold_edges_of(mesh) > 0 || changed_by_cleaning(mesh)) return test;
  const Crossings found = find_crossings(*test.joined, {.threads = all_threads(), .any_one = true, .is_late = is_late});
  test.is_usable = found.pairs.empty();
  if (test.is_usable)
    report.tested = static_cast<double>(found.tested) / static_cast<double>(test.joined->faces.size());
  return test;
}

bool usable(const Mesh& mesh) {
  ExtractReport unused;
  return test_usable(mesh, unused).is_usable;
}

Mesh remove_crossings(const Mesh& mesh, double visibility_s, ExtractReport& report, const IsLate& is_late) {
  Mesh m = mesh;
  for (int round = 0;; ++round) {
    MeshReadReport changes;
    clean(m, changes);
    Mesh surface = joined(m, report);
    if (round < kRoundsApart) draw_apart(surface);
    const Pairs crossings = crossing_faces(surface);
    if (!crossings.empty()) {
      m = without_crossings(surface, crossings, visibility_s, late(is_late));
    } else if (!usable(surface)) {
      m = std::move(surface);
    } else {
      close_slits(surface, is_late);
      return surface;
    }
  }
}

Mesh repaired(const Mesh& mesh, const ExtractOptions& options, const RepairTime& time, ExtractReport& report,
              const ProgressSink& progress) {
  return Repairer(mesh, options, time, report, progress).run(report);
}

}  // namespace triskin::mesh
