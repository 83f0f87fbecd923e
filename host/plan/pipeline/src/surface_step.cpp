// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_step.hpp"

#include <optional>
#include <utility>

#include "resolve_regions.hpp"
#include "triskin/mesh/extract.hpp"
#include "triskin/mesh/open_side.hpp"

namespace triskin::pipeline {
namespace {

std::optional<design::Design::PartSource> part_source(const mesh::MeshReadReport& report,
                                                      const cad::FaceSelection& faces) {
  if (!report.part) return std::nullopt;
  return design::Design::PartSource{report.part->faces, report.part->face_count, report.part->deviation_mm,
                                    cad::selection_text(faces)};
}

// Returns the faces that were asked for, or those on which an older version of the part was covered.
cad::FaceSelection faces_of(const DesignOptions& options) {
  const bool is_asked = cad::selection_text(options.faces) != cad::selection_text({});
  if (is_asked || options.like == nullptr || !options.like->part) return options.faces;
  return cad::parse_selection(options.like->part->selection);
}

// With a fixed number of steps the repair's clock stands still, because the result must not depend on the time.
mesh::Extraction repaired(const DesignInWork& work, const design::Mesh& mesh, double end_s) {
  if (work.options.repair == RepairMode::kNever) {
    mesh::require_manifold(mesh, work.mesh.string());
    mesh::Extraction e = mesh::extract(mesh, work.progress);
    mesh::require_no_self_intersection(e.surface, work.mesh.string());
    return e;
  }
  mesh::ExtractOptions steps;
  steps.repair = steps.keep_usable = true;
  steps.outer = steps.wrap = mesh::ExtractOptions::When::kWhenNeeded;
  steps.repair_s = end_s;
  steps.clock_s = [&work] { return work.options.iterations > 0 ? 0.0 : work.budget.used_s(); };
  return mesh::extract(mesh, steps, work.progress);
}

// Takes the side to be covered, with its holes bridged; the original part goes into the design, for the checker.
bool take_surface(DesignInWork& work, mesh::Extraction& extraction) {
  mesh::TakenSide taken = mesh::take_side(extraction.surface, work.options.side);
  if (taken.is_undecided) {
    work.notes.side = std::move(taken);
    work.notes.part = std::move(extraction.surface);
    return false;
  }
  const design::Mesh part = std::exchange(extraction.surface, std::exchange(taken.surface, {}));
  if (work.options.bridge_mm > 0.0)
    work.notes.bridges = mesh::bridge_holes(extraction.surface, part, work.options.bridge_mm);
  if (taken.choice.has_wall) {
    const bool both = work.options.side.wanted == mesh::SideWanted::kBoth;
    work.design.side = design::PartSide{mesh::side_name(taken), taken.choice.is_certain, taken.choice.wall_mm,
                                        both ? design::Mesh{} : part};
  }
  work.design.surface = extraction.surface;
  work.notes.side = std::move(taken);
  return true;
}

}  // namespace

mesh::MeshFile read_part(DesignInWork& work) {
  const cad::FaceSelection faces = faces_of(work.options);
  mesh::MeshFile file = mesh::read_mesh(work.mesh, work.options.unit, work.options.object, faces);
  work.design.part = part_source(file.report, faces);
  work.design.scale_to_mm = file.report.scale_to_mm;
  work.notes.read = file.report;
  work.notes.reading = file.report.notes;
  return file;
}

bool make_surface(DesignInWork& work, const mesh::MeshFile& file, double end_s) {
  mesh::Extraction extraction = repaired(work, file.mesh, end_s);
  if (work.options.flip) mesh::turn_over(extraction.surface);
  work.notes.extract = extraction.report;
  if (!take_surface(work, extraction)) return false;
  if (work.options.regions)
    work.design.regions = resolve_regions(work.mesh, work.options.unit, file, extraction, *work.options.regions);
  return true;
}

}  // namespace triskin::pipeline
