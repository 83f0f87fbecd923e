// SPDX-License-Identifier: GPL-3.0-or-later
#include "why_few.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/lattice/what_refuses.hpp"
#include "triskin/mesh/open_side.hpp"

namespace triskin::cli {
namespace {

design::Vec3 size_of(const design::Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const auto& v : mesh.vertices) box.extend(v);
  if (box.isEmpty()) return design::Vec3::Zero();
  return box.sizes();
}

// Converts "center_gap_mm" to "--center-gap-mm".
std::string option_of(std::string limit) {
  std::ranges::replace(limit, '_', '-');
  return "--" + limit;
}

// What a limit that refused modules would have had them do, and the option that allows more.
std::string words_of_refusal(const std::string& limit) {
  const std::string beyond = fmt::format("by more than {}", option_of(limit));
  if (limit == "overrun_mm") return "would stick out past an edge " + beyond;
  if (limit == "penetration_mm") return "would overlap others " + beyond;
  if (limit == "center_gap_mm") return "would have the centre off the surface " + beyond;
  if (limit == "lift_mm") return "would stand off the surface " + beyond;
  if (limit == "depth_mm") return "would sink into the surface " + beyond;
  if (limit == "hinge_gap_mm") return "would have gaping joints, " + beyond;
  if (limit == "edge_error_mm") return "would have stretched joints, " + beyond;
  if (limit == "fold_rad") return "would have joints folded " + beyond;
  if (limit == "keep_out") return "would reach into a keep-out";
  if (limit == "outward") return "would stand on edge, since the surface is folded there";
  if (limit == "time_limit") return "were left out for lack of time; raise --time-limit-s";
  return "are refused by " + limit;
}

std::string obstacle_text(const lattice::Obstacle& o) {
  const std::string at = fmt::format("({:.0f}, {:.0f}, {:.0f})", o.place_mm.x(), o.place_mm.y(), o.place_mm.z());
  if (o.limit == "narrow")
    return fmt::format("; the surface is {:.3g} mm wide where it is widest, at {}, and a module is 26 mm high",
                       o.width_mm, at);
  if (o.radius_mm > 0.0)
    return fmt::format("; it is too curved: radius {:.0f} mm at {}, {:.0f} mm needed; {} {:.1f} would allow it",
                       o.radius_mm, at, std::ceil(o.needed_radius_mm), option_of(o.limit),
                       std::ceil(10.0 * o.needed_limit_mm) / 10.0);
  if (o.limit == "outward") return fmt::format("; a module would stand on its edge: the surface is folded at {}", at);
  return fmt::format("; at {} of {}, first at {}, it {}", o.places, counted(o.tried, "place"), at,
                     words_of_refusal(o.limit));
}

// If the solvers refuse a surface, there is no obstacle to name.
std::string obstacle_of(const design::Design& d, Output& output) {
  try {
    const auto o = lattice::what_refuses(mesh::Surface(d.surface), d.limits);
    if (!o) return {};
    output.result["obstacle"] = {{"limit", o->limit},
                                 {"place_mm", {o->place_mm.x(), o->place_mm.y(), o->place_mm.z()}}};
    if (o->width_mm > 0.0) output.result["obstacle"]["width_mm"] = o->width_mm;
    if (o->radius_mm > 0.0) {
      output.result["obstacle"]["radius_mm"] = o->radius_mm;
      output.result["obstacle"]["needed_radius_mm"] = o->needed_radius_mm;
    }
    return obstacle_text(*o);
  } catch (const InputError&) {
    return {};
  }
}

int holes_of(const design::Design& d) {
  return static_cast<int>(mesh::Surface(d.surface).border_loops().size()) - 1;
}

}  // namespace

std::string reason_of_nothing(const design::Design& d, bool unit_given, Output& output) {
  const design::Vec3 size = size_of(d.surface);
  const mesh::OpenSide side = mesh::open_side_of(d.surface);
  const std::string inward =
      side.is_open && side.toward_middle > 0.5
          ? "; its faces look at its own middle, where modules have less room: --flip takes the other side"
          : "";
  return fmt::format(
             "no module fits: the surface measures {:.4g} × {:.4g} × {:.4g} mm, a module is a triangle with sides of "
             "30 mm{}{}; no design was written",
             size.x(), size.y(), size.z(), obstacle_of(d, output),
             unit_given ? "" : "; the mesh was read in mm; if that is wrong, give --unit cm, m or in") +
         inward;
}

std::string low_coverage_text(const design::Design& d) {
  constexpr double kLowCoverage = 0.6;
  constexpr int kManyIslands = 3;
  if (d.report.coverage >= kLowCoverage) return {};
  std::vector<std::string> reasons;
  const auto most = std::ranges::max_element(d.layout.refused, {}, [](const auto& entry) { return entry.second; });
  if (most != d.layout.refused.end())
    reasons.push_back(fmt::format("{} more {} {}", most->second, noun_after(most->second == 1, "module"),
                                  words_of_refusal(most->first)));
  if (const int holes = holes_of(d); holes > 0)
    reasons.push_back(
        fmt::format("the surface has {} or extra {}", counted(holes, "hole"), agreeing(holes, "edge", "edges")));
  // Jumpers join islands and make no room: where limits or holes leave none, longer ones are no remedy.
  if (reasons.empty() && d.layout.islands >= kManyIslands && d.limits.jumper_mm < 2 * design::LayoutLimits{}.jumper_mm)
    reasons.push_back(fmt::format("{} {} on {}: longer jumpers (--jumper-mm {:.0f}) may join them",
                                  counted(d.layout.modules.size(), "module"),
                                  agreeing(d.layout.modules.size(), "lies", "lie"), counted(d.layout.islands, "island"),
                                  2 * design::LayoutLimits{}.jumper_mm));
  if (reasons.empty()) reasons.emplace_back("a longer --time-limit-s may place more modules");
  return fmt::format("Low coverage, {:.1f} %: {}", 100.0 * d.report.coverage, fmt::join(reasons, "; "));
}

}  // namespace triskin::cli
