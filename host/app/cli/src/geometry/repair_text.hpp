// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "triskin/base/counted.hpp"
#include "triskin/mesh/extract.hpp"

namespace triskin::cli {

/// Says what could not be done in the available time, or was left out because of it; empty if there was nothing.
[[nodiscard]] inline std::string shortage_text(const mesh::ExtractReport& r) {
  std::string text;
  if (r.tested < 1.0) {
    text = fmt::format(
        "only {:.1f} % of the faces could be tested for intersections in the time limit; the others may intersect "
        "(raise --time-limit-s)",
        100.0 * r.tested);
  }
  if (r.reduced_mm > 0.0) {
    text += fmt::format(
        "{}the mesh needed a repair, is too large for the time limit and was simplified first, by at most {:.3f} mm",
        text.empty() ? "" : "; ", r.reduced_mm);
  }
  return text;
}

/// Says what the repair of a mesh changed, in mm and where, and what it dropped; empty if it changed nothing. `option`
/// disables the repair.
[[nodiscard]] inline std::string repair_text(const mesh::ExtractReport& r, const char* option) {
  static constexpr std::array<const char*, 4> kDone{
      "", "faces that cross were divided along their common lines and hidden parts dropped",
      "a surface was wrapped around it", "a surface was wrapped around it on a grid"};
  std::string text;
  if (r.enclosed_components > 0) {
    text = fmt::format(
        "{} of the mesh lie in a closed part, where no module can be brought, and were dropped (--{} never keeps them)",
        counted(r.enclosed_components, "part"), option);
  }
  if (r.repair == mesh::Repair::kNone) return text;
  const mesh::Deviation& d = r.deviation;
  const std::string reason =
      r.crossings + r.non_manifold_edges > 0
          ? fmt::format("{} pairs of faces cross, {} edges have more than two faces", r.crossings, r.non_manifold_edges)
          : "its parts are smaller than a module, or touch without being joined";
  if (!text.empty()) text += "; ";
  return text + fmt::format(
                    "the mesh was repaired ({}): {}; it moved by {:.3f} mm in the mean and by at most {:.2f} mm "
                    "({:.2f} mm found), "
                    "near ({:.1f}, "
                    "{:.1f}, {:.1f}) mm",
                    reason, kDone[static_cast<std::size_t>(r.repair)], d.mean_mm, d.largest_mm, d.found_mm,
                    d.where_mm.x(), d.where_mm.y(), d.where_mm.z());
}

/// Names the largest dropped part with area and place, and counts the others; empty without any.
[[nodiscard]] inline std::string dropped_text(const mesh::ExtractReport& r) {
  if (r.dropped.empty()) return {};
  const mesh::DroppedPart& largest = *std::ranges::max_element(r.dropped, {}, &mesh::DroppedPart::area_mm2);
  double others_mm2 = -largest.area_mm2;
  for (const mesh::DroppedPart& part : r.dropped) others_mm2 += part.area_mm2;
  std::string text =
      fmt::format("left out: a part of {:.2f} cm² near ({:.1f}, {:.1f}, {:.1f}) mm", largest.area_mm2 / 100.0,
                  largest.where_mm.x(), largest.where_mm.y(), largest.where_mm.z());
  if (r.dropped.size() > 1)
    text +=
        fmt::format(" and {} of {:.2f} cm² in all", counted(r.dropped.size() - 1, "smaller one"), others_mm2 / 100.0);
  return text + " (dropped in the --json output)";
}

}  // namespace triskin::cli
