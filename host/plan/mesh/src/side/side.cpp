// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mesh/side.hpp"

#include <algorithm>

#include "edge_sides.hpp"
#include "ray_caster.hpp"
#include "side_decision.hpp"
#include "side_evidence.hpp"
#include "smooth_regions.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/index.hpp"
#include "triskin/mesh/extract.hpp"
#include "triskin/mesh/extract_steps.hpp"
#include "wall.hpp"

namespace triskin::mesh {
namespace {

double median_wall(const std::vector<WallSample>& samples) {
  std::vector<double> walls;
  for (const WallSample& s : samples) {
    if (s.partner >= 0) walls.push_back(s.wall_mm);
  }
  if (walls.empty()) return 0.0;
  const auto middle = walls.begin() + static_cast<std::ptrdiff_t>(walls.size() / 2);
  std::nth_element(walls.begin(), middle, walls.end());
  return *middle;
}

// An open surface with a smaller walled fraction is a sheet with folds. The limit is a tenth below the one of the
// decision.
constexpr double kMinWalledOpen = 0.15;

constexpr double kVisibility_s = 0.2;  // The view of crossing faces, which are rare, may take this much processor time.

bool has_border(const std::vector<std::array<FaceIndex, 3>>& neighbours) {
  return std::ranges::any_of(neighbours, [](const auto& n) { return n[0] < 0 || n[1] < 0 || n[2] < 0; });
}

SideChoice one_side(const Mesh& mesh) {
  SideChoice choice;
  choice.regions.resize(1);
  choice.region_of_face.assign(mesh.faces.size(), 0);
  choice.choice_of_face.assign(mesh.faces.size(), 0);
  return choice;
}

// If nobody asks for a side, kOuter takes the side that was chosen for the undecided faces.
bool is_taken(const SideChoice& choice, FaceIndex face, const SideOptions& options) {
  const bool wants_inner = options.wanted == SideWanted::kInner;
  switch (choice.side_of(face)) {
    case FaceSide::kOuter:
      return !wants_inner;
    case FaceSide::kInner:
      return wants_inner;
    case FaceSide::kRim:
      return false;
    case FaceSide::kUndecided:
      break;
  }
  int wanted = options.choice;
  if (wanted == 0 && options.wanted == SideWanted::kOuter) wanted = 1;
  if (wanted == 0 && wants_inner) wanted = 2;
  return wanted > 0 && choice.choice_of_face[at(face)] == wanted;
}

double area_of_face(const Mesh& mesh, const std::array<int, 3>& f) {
  const Vec3& a = mesh.vertices[at(f[0])];
  return 0.5 * (mesh.vertices[at(f[1])] - a).cross(mesh.vertices[at(f[2])] - a).norm();
}

}  // namespace

std::string side_name(const TakenSide& taken) {
  if (!taken.choice.has_wall) return "whole";
  if (taken.is_undecided) return "undecided";
  if (taken.options.from_mm) return "from";
  if (taken.options.choice > 0) return std::to_string(taken.options.choice);
  const SideWanted wanted = taken.options.wanted;
  return std::string(kSideWantedNames.name(wanted == SideWanted::kAuto ? SideWanted::kOuter : wanted));
}

TakenSide take_side(const Mesh& part, const SideOptions& options) {
  TakenSide taken;
  taken.options = options;
  taken.choice = find_sides(part, options);
  const SideChoice& choice = taken.choice;
  Mesh kept{part.vertices, {}};
  for (std::size_t f = 0; f < part.faces.size(); ++f) {
    const FaceIndex face(f);
    const double area = area_of_face(part, part.faces[f]);
    taken.part_mm2 += area;
    if (!choice.has_wall || options.wanted == SideWanted::kBoth || is_taken(choice, face, options)) {
      kept.faces.push_back(part.faces[f]);
      taken.taken_mm2 += area;
    } else if (choice.side_of(face) == FaceSide::kRim) {
      ++taken.rim_faces;
    } else if (choice.side_of(face) == FaceSide::kUndecided && options.wanted == SideWanted::kAuto) {
      taken.undecided_mm2 += area;
    }
  }
  taken.is_undecided = !choice.is_certain && options.wanted == SideWanted::kAuto && options.choice == 0;
  if (taken.is_undecided) return taken;
  if (kept.faces.size() == part.faces.size()) {
    taken.surface = part;
    return taken;
  }
  if (kept.faces.empty())
    throw InputError("side: nothing of the part lies on the side that was asked for; try --side both, or --from X,Y,Z");
  ExtractReport unused;
  try {
    taken.surface = extract(kept).surface;
  } catch (const InputError&) {
    throw InputError(
        "side: no connected part of the side that was taken is as large as one module (3.9 cm²); try --side both, or "
        "--from X,Y,Z");
  }
  // Outer faces that were joined only at a corner now have coinciding corners.
  if (!usable(taken.surface)) taken.surface = remove_crossings(taken.surface, kVisibility_s, unused);
  return taken;
}

SideChoice find_sides(const Mesh& mesh, const SideOptions& options) {
  if (!(options.min_wall_mm > 0.0 && options.max_wall_mm > options.min_wall_mm))
    throw InputError("side: the wall's least thickness must be over 0 mm and under its largest");
  const RayCaster part(mesh, options.threads);
  const auto neighbours = neighbours_of(mesh);
  if (!options.is_asked() && has_border(neighbours) && walled_fraction_of_few(part, options) < kMinWalledOpen)
    return one_side(mesh);
  const std::vector<WallSample> samples = wall_samples(part, options);
  SmoothRegions regions = smooth_regions(part, neighbours, samples);
  const SideEvidence evidence = side_evidence(part, neighbours, regions, samples, options);
  const SideDecision decision = decide_sides(evidence, options);
  SideChoice choice;
  choice.has_wall = decision.has_wall;
  choice.is_certain = decision.is_certain;
  choice.has_loose_sheets = decision.has_loose_sheets;
  choice.margin = decision.margin;
  if (decision.has_wall) choice.enclosed = decision.enclosed;
  choice.wall_mm = decision.has_wall ? median_wall(samples) : 0.0;
  for (std::size_t r = 0; r < evidence.regions.size(); ++r) {
    const RegionEvidence& e = evidence.regions[r];
    choice.regions.push_back({decision.side[r], e.area_mm2, e.area_mm2 > 0.0 ? e.walled_mm2 / e.area_mm2 : 0.0,
                              e.wall_mm, e.visibility, e.hull_depth_mm, decision.outwardness[r]});
  }
  for (const int r : regions.of_face) choice.choice_of_face.push_back(decision.choice[at(r)]);
  choice.region_of_face = std::move(regions.of_face);
  return choice;
}

}  // namespace triskin::mesh
