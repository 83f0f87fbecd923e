// SPDX-License-Identifier: GPL-3.0-or-later
#include "resolve_regions.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>

#include "triskin/base/error.hpp"

namespace triskin::pipeline {
namespace {

constexpr double kSame_mm = 0.01;  // The middles of a face in the file and on the surface may differ by this much.

using Cell = std::array<long, 3>;

design::Vec3 middle_of(const design::Mesh& mesh, design::FaceIndex face) {
  const auto& f = mesh.faces[static_cast<std::size_t>(face)];
  design::Vec3 sum = design::Vec3::Zero();
  for (const int v : f) sum += mesh.vertices[static_cast<std::size_t>(v)];
  return sum / 3.0;
}

Cell cell_of(const design::Vec3& p) {
  return {std::lround(p.x() / kSame_mm), std::lround(p.y() / kSame_mm), std::lround(p.z() / kSame_mm)};
}

bool is_near(const std::map<Cell, design::Vec3>& places, const design::Vec3& p) {
  const Cell c = cell_of(p);
  for (long x = -1; x <= 1; ++x) {
    for (long y = -1; y <= 1; ++y) {
      for (long z = -1; z <= 1; ++z) {
        const auto found = places.find({c[0] + x, c[1] + y, c[2] + z});
        if (found != places.end() && (found->second - p).norm() <= kSame_mm) return true;
      }
    }
  }
  return false;
}

}  // namespace

design::Regions resolve_regions(const std::filesystem::path& mesh, std::optional<mesh::LengthUnit> unit,
                                const mesh::MeshFile& file, const mesh::Extraction& surface,
                                const design::RegionFile& wanted) {
  design::Regions regions;
  regions.elsewhere = wanted.elsewhere;
  for (const design::WantedRegion& w : wanted.regions) {
    regions.list.push_back(w.region);
    if (auto* obstacle = std::get_if<design::Obstacle>(&regions.list.back().shape))
      obstacle->mesh =
          w.file.empty() ? mesh::read_body(mesh, unit, w.object) : mesh::read_body(w.file, std::nullopt, w.object);
    auto* set = std::get_if<design::FaceSet>(&regions.list.back().shape);
    if (set == nullptr) continue;
    const auto refuse = [&](const std::string& what) -> void {
      throw InputError(fmt::format("region \"{}\": {}; see docs/regions.md", w.region.name, what));
    };
    if (surface.report.repair != mesh::Repair::kNone || surface.report.reduced_mm > 0.0)
      refuse("the mesh had to be repaired, so its faces are others: give a sphere or a box");
    std::map<Cell, design::Vec3> places;
    const auto add = [&](const design::Mesh& m, design::FaceIndex face) {
      const design::Vec3 p = middle_of(m, face);
      places.emplace(cell_of(p), p);
    };
    if (w.group.empty()) {
      for (const design::FaceIndex f : set->faces) {
        if (f >= static_cast<int>(file.mesh.faces.size()))
          refuse(fmt::format("face {} is not there; the mesh has 0 … {}", f, file.mesh.faces.size() - 1));
        add(file.mesh, f);
      }
    } else {
      const design::Mesh group = mesh::read_obj_group(mesh, w.group, file.report.scale_to_mm);
      for (design::FaceIndex f{0}; f < static_cast<int>(group.faces.size()); ++f) add(group, f);
    }
    set->faces.clear();
    for (design::FaceIndex f{0}; f < static_cast<int>(surface.surface.faces.size()); ++f) {
      if (is_near(places, middle_of(surface.surface, f))) set->faces.push_back(f);
    }
    if (set->faces.empty()) refuse("none of its faces belongs to the surface that can be covered");
  }
  return regions;
}

}  // namespace triskin::pipeline
