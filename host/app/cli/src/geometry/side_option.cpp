// SPDX-License-Identifier: GPL-3.0-or-later
#include "side_option.hpp"

#include <fmt/format.h>

#include "number_list.hpp"
#include "side_picture.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"

namespace triskin::cli {
namespace {

// Formats 1347.1 as "1,347".
std::string whole_cm2(double area_mm2) {
  std::string text = fmt::format("{:.0f}", area_mm2 / 100.0);
  for (int k = static_cast<int>(text.size()) - 3; k > 0; k -= 3) text.insert(static_cast<std::size_t>(k), ",");
  return text;
}

std::string name_of(const mesh::SideOptions& options) {
  if (options.from_mm) return "the side seen from the point";
  if (options.choice > 0) return fmt::format("side {}", options.choice);
  return options.wanted == mesh::SideWanted::kInner ? "inner side" : "outer side";
}

}  // namespace

void SideOption::add_to(CLI::App& app) {
  app.add_option(
         "--side", side_,
         "side of a walled part: auto (the outer one), or side 1 or 2 of the picture drawn in doubt (docs/mesh.md)")
      ->check(CLI::IsMember({"auto", "outer", "inner", "both", "1", "2"}))
      ->capture_default_str();
  app.add_option("--from", from_, "x,y,z in mm: take the side that is seen from this point");
  app.add_option("--bridge-mm", bridge_mm_, "let modules span holes up to this diameter (0: none)")
      ->check(CLI::Range(0.0, 60.0))
      ->capture_default_str();
}

mesh::SideOptions SideOption::options() const {
  mesh::SideOptions options;
  if (const auto wanted = mesh::kSideWantedNames.value(side_)) {
    options.wanted = *wanted;
  } else {
    options.choice = side_ == "1" ? 1 : 2;
  }
  if (from_.empty()) return options;
  const std::vector<double> p = numbers_of(from_);
  if (p.size() != 3) throw InputError(fmt::format("--from {}: wanted x,y,z in mm", from_));
  if (side_ != "auto") throw InputError("--from says which side is wanted; give it without --side");
  options.from_mm = design::Vec3(p[0], p[1], p[2]);
  options.wanted = mesh::SideWanted::kOuter;
  return options;
}

std::string side_text(const mesh::TakenSide& taken) {
  if (taken.choice.has_loose_sheets)
    return "the mesh has sheets back to back that no rim joins; all are kept (--side outer takes one side)";
  if (!taken.choice.has_wall) {
    if (!taken.options.is_asked()) return {};
    return fmt::format(
        "{} was asked for, but the part has no wall of {} to {} mm to tell sides by: all of its surface is taken; "
        "choose "
        "faces of a CAD file (triskin faces), or cut the mesh",
        name_of(taken.options), taken.options.min_wall_mm, taken.options.max_wall_mm);
  }
  const std::string areas = fmt::format("{} of {} cm², wall {:.1f} mm", whole_cm2(taken.taken_mm2),
                                        whole_cm2(taken.part_mm2), taken.choice.wall_mm);
  if (taken.options.wanted == mesh::SideWanted::kBoth) return "both sides: " + areas;
  const bool is_inner = taken.options.wanted == mesh::SideWanted::kInner;
  std::string text = fmt::format("{}: {}; {} side and {} rim faces left out", name_of(taken.options), areas,
                                 is_inner ? "outer" : "inner", taken.rim_faces);
  if (taken.choice.enclosed > 0 && !is_inner)
    text += fmt::format("; parts inside of another one left out: {} (--object takes one)", taken.choice.enclosed);
  if (taken.undecided_mm2 >= 100.0) {
    text += fmt::format("; so were {} cm² whose two sides look alike (--side 1 or 2 takes one)",
                        whole_cm2(taken.undecided_mm2));
  }
  return text;
}

std::string bridge_text(const mesh::BridgeReport& report) {
  if (report.bridged + report.kept_out + report.left_open == 0) return {};
  return fmt::format(
      "{} bridged, {:.1f} cm²; {} left open because something stands out of them, {} because their lid would "
      "cross the surface",
      counted(report.bridged, "hole"), report.area_mm2 / 100.0, report.kept_out, report.left_open);
}

int report_undecided(const design::Mesh& part, const mesh::TakenSide& taken, const std::string& picture,
                     Output& output) {
  write_output(picture, side_svg(part, taken.choice));
  const std::string reason = fmt::format(
      "both sides of the wall look alike on {} cm²: {} shows them; say --side 1 or --side 2, or --from X,Y,Z with a "
      "point that sees the outer side; nothing was written",
      whole_cm2(taken.undecided_mm2), picture);
  add_side_keys(taken, output);
  output.result["picture"] = picture;
  output.result["reason"] = reason;
  output.say(reason);
  return 1;
}

void add_side_keys(const mesh::TakenSide& taken, Output& output) {
  output.result["side"] = mesh::side_name(taken);
  output.result["side_certain"] = taken.choice.is_certain;
  output.result["wall_mm"] = taken.choice.wall_mm;
  if (!taken.choice.has_wall) return;
  output.result["side_margin"] = taken.choice.margin;
  output.result["side_cm2"] = taken.taken_mm2 / 100.0;
  output.result["part_cm2"] = taken.part_mm2 / 100.0;
}

}  // namespace triskin::cli
