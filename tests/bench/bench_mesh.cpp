// SPDX-License-Identifier: GPL-3.0-or-later
// Measures speed against error of preparing a part: decimation by deviation and by size, repair by size and by time
// limit, the side of a wall by size.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "bench.hpp"
#include "triskin/mesh/decimated_mesh.hpp"
#include "triskin/mesh/extract.hpp"
#include "triskin/mesh/generate.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/mesh/side.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::cli {
namespace {

using nlohmann::json;

design::Mesh generated(const char* shape, int faces) {
  return mesh::generate(*mesh::shape_named(shape), {.size_mm = 0.0, .faces = faces});
}

json decimation(const char* series, const mesh::Surface& surface, double deviation_mm) {
  const double start = processor_s();
  const mesh::DecimatedMesh made = mesh::decimate(surface, deviation_mm, deviation_mm, 1);
  return {{"series", series},
          {"faces", surface.mesh().faces.size()},
          {"asked_mm", deviation_mm},
          {"left", made.mesh.faces.size()},
          {"deviation_mm", made.deviation_mm},
          {"processor_s", processor_s() - start}};
}

json repair(const char* series, int faces, double limit_s) {
  mesh::ExtractOptions options;
  options.repair = true;
  options.repair_s = limit_s;
  options.keep_usable = true;
  options.outer = options.wrap = mesh::ExtractOptions::When::kWhenNeeded;  // As a design does.
  const Scratch scratch;
  mesh::write_mesh(scratch.path() / "part.obj", generated("dirty-shell", faces));
  const design::Mesh part = mesh::read_mesh(scratch.path() / "part.obj").mesh;
  const double start = processor_s_with_children();
  const mesh::Extraction made = mesh::extract(part, options);
  double dropped_mm2 = 0.0;
  for (const mesh::DroppedPart& d : made.report.dropped) dropped_mm2 += d.area_mm2;
  return {{"series", series},
          {"faces", part.faces.size()},
          {"limit_s", limit_s},
          {"left", made.surface.faces.size()},
          {"crossings", made.report.crossings},
          {"dropped_mm2", dropped_mm2},
          {"repair", std::string(mesh::kRepairNames.name(made.report.repair))},
          {"reduced_mm", made.report.reduced_mm},
          {"deviation_mm", made.report.deviation.largest_mm},
          {"found_mm", made.report.deviation.found_mm},
          {"tested", made.report.tested},
          {"usable", mesh::usable(made.surface)},
          {"processor_s", processor_s_with_children() - start}};
}

// A box of 160 × 110 × 70 mm without its floor, with a wall of 3 mm: five outer plates, five inner ones and the rim.
// Each plate is a grid of about `faces` / 10 triangles.
design::Mesh walled_box(int faces) {
  design::Mesh m;
  const int cells = std::max(2, static_cast<int>(std::lround(std::sqrt(faces / 20.0))));
  const auto plate = [&](const design::Vec3& corner, const design::Vec3& u, const design::Vec3& v, int rows) {
    const int first = static_cast<int>(m.vertices.size());
    for (int j = 0; j <= rows; ++j) {
      for (int i = 0; i <= cells; ++i) m.vertices.push_back(corner + u * i / cells + v * j / rows);
    }
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < cells; ++i) {
        const int a = first + j * (cells + 1) + i, b = a + cells + 1;
        m.faces.push_back({a, a + 1, b + 1});
        m.faces.push_back({a, b + 1, b});
      }
    }
  };
  // The four sides and the lid, with u × v pointing outward; `sign` −1 turns a plate over for the inner sheet.
  const auto shell = [&](const design::Vec3& low, const design::Vec3& high, bool outward) {
    const design::Vec3 d = high - low, x(d.x(), 0, 0), y(0, d.y(), 0), z(0, 0, d.z());
    const auto side = [&](const design::Vec3& corner, const design::Vec3& u, const design::Vec3& v) {
      outward ? plate(corner, u, v, cells) : plate(corner, v, u, cells);
    };
    side(low, x, z);
    side(low + x, y, z);
    side(low + x + y, -x, z);
    side(low + y, -y, z);
    side(low + z, x, y);
  };
  const design::Vec3 low(0, 0, 0), high(160, 110, 70), wall(3, 3, 0);
  shell(low, high, true);
  shell(low + wall, high - design::Vec3(3, 3, 3), false);
  // The rim at z = 0 joins both sheets; it looks down.
  const auto rim = [&](const design::Vec3& a, const design::Vec3& b, const design::Vec3& inner_b,
                       const design::Vec3& inner_a) {
    const int first = static_cast<int>(m.vertices.size());
    for (int i = 0; i <= cells; ++i) m.vertices.push_back(a + (b - a) * i / cells);
    for (int i = 0; i <= cells; ++i) m.vertices.push_back(inner_a + (inner_b - inner_a) * i / cells);
    for (int i = 0; i < cells; ++i) {
      const int p = first + i, q = first + cells + 1 + i;
      m.faces.push_back({p, q + 1, p + 1});
      m.faces.push_back({p, q, q + 1});
    }
  };
  const std::array<design::Vec3, 4> outer{low, design::Vec3(160, 0, 0), design::Vec3(160, 110, 0),
                                          design::Vec3(0, 110, 0)};
  const std::array<design::Vec3, 4> inner{design::Vec3(3, 3, 0), design::Vec3(157, 3, 0), design::Vec3(157, 107, 0),
                                          design::Vec3(3, 107, 0)};
  for (std::size_t k = 0; k < 4; ++k) rim(outer[k], outer[(k + 1) % 4], inner[(k + 1) % 4], inner[k]);
  return m;
}

// The outer sheet of the walled box, by formula: four sides and a lid.
constexpr double kOuter_mm2 = 2.0 * (160.0 + 110.0) * 70.0 + 160.0 * 110.0;

json side(int faces) {
  const Scratch scratch;
  mesh::write_mesh(scratch.path() / "box.obj", walled_box(faces));
  // Reading welds the plates at their common edges.
  const mesh::Extraction part = mesh::extract(mesh::read_mesh(scratch.path() / "box.obj").mesh);
  const double start = processor_s();
  mesh::SideOptions options;
  options.threads = 1;
  const mesh::TakenSide taken = mesh::take_side(part.surface, options);
  return {{"series", "side"},
          {"faces", part.surface.faces.size()},
          {"certain", taken.choice.is_certain && taken.choice.has_wall},
          {"wrong_share", std::abs(taken.taken_mm2 / kOuter_mm2 - 1.0)},
          {"processor_s", processor_s() - start}};
}

json rows(const BenchOptions& options, Output&) {
  json result = json::array();
  const mesh::Surface torso(generated("torso", options.quick ? 30'000 : 100'000));
  for (const double deviation_mm : {0.0025, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0})
    result.push_back(decimation("decimation", torso, deviation_mm));
  for (const int faces : {5'000, 20'000, 80'000, 320'000}) {
    if (options.quick && faces > 80'000) continue;
    result.push_back(decimation("decimation by size", mesh::Surface(generated("torso", faces)), 0.05));
  }
  for (const int faces : {1'500, 6'000, 24'000, 96'000}) {
    if (options.quick && faces > 24'000) continue;
    result.push_back(repair("repair by size", faces, 1e4));
  }
  for (const double limit_s : {0.3, 1.0, 3.0, 10.0}) result.push_back(repair("repair by limit", 24'000, limit_s));
  for (const int faces : {2'000, 8'000, 32'000, 128'000}) {
    if (options.quick && faces > 32'000) continue;
    result.push_back(side(faces));
  }
  return result;
}

const BenchSubject kMesh("mesh", "decimation, repair and the side of a wall: time against deviation and size", rows);

}  // namespace
}  // namespace triskin::cli
