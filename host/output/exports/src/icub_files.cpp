// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/exports/icub_files.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "metres.hpp"
#include "triskin/base/ascii_name.hpp"
#include "triskin/base/error.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/layout/module.hpp"

namespace triskin::exports {
namespace {

constexpr int kRepresentative = 3;  // Taxel 3 lies at the centroid.
constexpr int kTaxels = static_cast<int>(layout::kTaxelsPerModule);

std::vector<design::ModuleWiring> wiring_for_icub(const design::Design& design) {
  const auto wiring = design::wiring_of(design);
  for (std::size_t k = 0; k < wiring.size(); ++k) {
    if (wiring[k].patch < 0)
      throw InputError(
          fmt::format("export: module {} belongs to no controller, so no iCub host reads it; make the design again "
                      "with triskin design",
                      design::number_of(design, static_cast<int>(k))));
  }
  if (design.patches.size() > kIcubBoards)
    throw InputError(
        fmt::format("export: {} controllers; a bus of an iCub has {} boards at most. Divide the part and design each "
                    "piece by itself",
                    design.patches.size(), kIcubBoards));
  return wiring;
}

// Words in a YARP file end at spaces and brackets, so these are replaced.
std::string word(const std::string& name) {
  return ascii_name(name, "", "part");
}

using Row = std::array<double, 6>;

// Returns the direction of side `rotation` of a tile in the plane of the lattice, in degrees, (−180, 180].
double orientation_deg(const design::Tile& tile, int rotation) {
  const auto from = design::tile_corner_index(tile, rotation), to = design::tile_corner_index(tile, (rotation + 1) % 3);
  const design::Vec2 along = design::grid_point(to[0], to[1]) - design::grid_point(from[0], from[1]);
  return std::round(std::atan2(along.y(), along.x()) * 180.0 / std::numbers::pi);
}

design::Vec2 center_of(const design::Tile& tile) {
  design::Vec2 sum(0, 0);
  for (int c = 0; c < 3; ++c) {
    const auto [i, j] = design::tile_corner_index(tile, c);
    sum += design::grid_point(i, j);
  }
  return sum / 3.0;
}

// Returns a shift for each island, so that they form a row and no two triangles look like neighbours.
std::map<int, design::Vec2> row_of_islands(const design::Design& design) {
  constexpr double kGap_mm = 40.0;
  std::map<int, Eigen::AlignedBox2d> boxes;
  for (const design::PlacedModule& m : design.layout.modules) boxes[m.island].extend(center_of(m.tile));
  std::map<int, design::Vec2> shifts;
  double left_mm = 0.0;
  for (const auto& [island, box] : boxes) {
    shifts[island] = design::Vec2(left_mm, 0.0) - box.min();
    left_mm += box.sizes().x() + kGap_mm;
  }
  return shifts;
}

}  // namespace

std::string icub_positions(const design::Design& design) {
  const auto wiring = wiring_for_icub(design);
  const std::size_t taxels = design.patches.size() * kIcubTriangles * kTaxels;
  std::vector<Row> rows(taxels, Row{});
  std::vector<int> representative(taxels, -1);
  for (std::size_t k = 0; k < wiring.size(); ++k) {
    const int first = kTaxels * icub_triangle(wiring[k]);
    const auto poses = design::taxels_of(design.layout.modules[k], wiring[k].routed.rotation);
    for (int t = 0; t < kTaxels; ++t) {
      if (!layout::measures_pressure(static_cast<std::size_t>(t))) continue;
      const design::Vec3 p = poses[static_cast<std::size_t>(t)].position_mm * kMetres_per_mm,
                         n = poses[static_cast<std::size_t>(t)].normal;
      rows[static_cast<std::size_t>(first + t)] = {p.x(), p.y(), p.z(), n.x(), n.y(), n.z()};
      representative[static_cast<std::size_t>(first + t)] = first + kRepresentative;
    }
  }
  std::string text = fmt::format("name    {}\nspatial_sampling    taxel\ntaxel2Repr    (", word(design.name));
  for (const int r : representative) text += fmt::format(" {}", r);
  text += " )\n[calibration]\n";
  for (const Row& r : rows)
    text += fmt::format("{:.6f}\t{:.6f}\t{:.6f}\t{:.6f}\t{:.6f}\t{:.6f}\n", r[0], r[1], r[2], r[3], r[4], r[5]);
  return text;
}

std::string icub_skingui(const design::Design& design) {
  const auto wiring = wiring_for_icub(design);
  if (static_cast<int>(design.patches.size()) * kIcubTriangles > kSkinGuiTriangles)
    throw InputError(fmt::format(
        "export: {} controllers have {} triangles; skinGui draws {}. Divide the part and export each piece by itself",
        design.patches.size(), kIcubTriangles * static_cast<int>(design.patches.size()), kSkinGuiTriangles));
  const auto shifts = row_of_islands(design);
  std::string text = "cardid";
  // The place in this list is the number of the controller; one that does not exist has the address that it would have.
  for (layout::PatchIndex p; p < static_cast<int>(design.patches.size()); ++p)
    text += fmt::format(
        " {}", design::has_patch(design, p) ? design::node_address_of(design, p).value() : p + layout::kFirstNode);
  text += fmt::format("\nrobotPart {}\nwidth 600\nheight 400\n\n[SENSORS]\n", word(design.name));
  std::map<int, std::string> rows;
  for (std::size_t k = 0; k < wiring.size(); ++k) {
    const design::PlacedModule& m = design.layout.modules[k];
    const design::Vec2 at = center_of(m.tile) + shifts.at(m.island);
    const int number = icub_triangle(wiring[k]);
    rows[number] = fmt::format("triangle_10pad\t{}\t{:.2f}\t{:.2f}\t{:.2f}\t5\t0\t0\n", number, at.x(), at.y(),
                               orientation_deg(m.tile, wiring[k].routed.rotation));
  }
  for (const auto& [number, row] : rows) text += row;
  return text;
}

}  // namespace triskin::exports
