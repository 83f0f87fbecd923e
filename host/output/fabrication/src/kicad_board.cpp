// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "board_art.hpp"
#include "kicad.hpp"
#include "kicad_text.hpp"

namespace triskin::fabrication {
namespace {

using design::PlacedModule;
using design::Vec2;

constexpr double kPageMargin_mm = 20.0;
constexpr const char* kBoardLayers =
    "  (layers\n    (0 \"F.Cu\" signal)\n    (1 \"In1.Cu\" signal)\n    (2 \"In2.Cu\" signal)\n    (31 \"B.Cu\" "
    "signal)\n"
    "    (34 \"B.Paste\" user)\n    (35 \"F.Paste\" user)\n    (36 \"B.SilkS\" user \"B.Silkscreen\")\n"
    "    (37 \"F.SilkS\" user \"F.Silkscreen\")\n    (38 \"B.Mask\" user)\n    (39 \"F.Mask\" user)\n"
    "    (41 \"Cmts.User\" user \"User.Comments\")\n    (44 \"Edge.Cuts\" user)\n    (45 \"Margin\" user)\n"
    "    (46 \"B.CrtYd\" user \"B.Courtyard\")\n    (47 \"F.CrtYd\" user \"F.Courtyard\")\n    (48 \"B.Fab\" user)\n"
    "    (49 \"F.Fab\" user)\n    (50 \"User.1\" user \"Folds\")\n    (51 \"User.2\" user \"Slits\")\n"
    "    (52 \"User.3\" user \"Marks\")\n  )\n";
// The default is polyimide flex of four layers; a board house will change it.
constexpr const char* kBoardSetup =
    "  (setup\n    (stackup\n"
    "      (layer \"F.Mask\" (type \"Top Solder Mask\") (thickness 0.025))\n"
    "      (layer \"F.Cu\" (type \"copper\") (thickness 0.018))\n"
    "      (layer \"dielectric 1\" (type \"core\") (thickness 0.05) (material \"Polyimide\") (epsilon_r 3.4) "
    "(loss_tangent 0.004))\n"
    "      (layer \"In1.Cu\" (type \"copper\") (thickness 0.018))\n"
    "      (layer \"dielectric 2\" (type \"prepreg\") (thickness 0.05) (material \"Polyimide\") (epsilon_r 3.4) "
    "(loss_tangent 0.004))\n"
    "      (layer \"In2.Cu\" (type \"copper\") (thickness 0.018))\n"
    "      (layer \"dielectric 3\" (type \"core\") (thickness 0.05) (material \"Polyimide\") (epsilon_r 3.4) "
    "(loss_tangent 0.004))\n"
    "      (layer \"B.Cu\" (type \"copper\") (thickness 0.018))\n"
    "      (layer \"B.Mask\" (type \"Bottom Solder Mask\") (thickness 0.025))\n"
    "      (copper_finish \"ENIG\")\n      (dielectric_constraints no)\n    )\n    (pad_to_mask_clearance 0)\n  )\n";

class Board {
 public:
  Board(const design::Design& design, const sheet::Sides& sides, const FlatIsland& island)
      : design_(design), island_(island) {
    for (const Vec2& p : island.outline_mm) high_mm_ = high_mm_.cwiseMax(p);
    const BoardArt art = board_art(design, sides, island);
    for (const ArtFootprint& part : art.footprints) footprint(part);
    for (const ArtTrack& t : art.tracks)
      items_ += fmt::format("  (segment (start {}) (end {}) (width {:g}) (layer \"{}\") (net {}))\n", at(t.from_mm),
                            at(t.to_mm), t.width_mm, copper_layer_name(t.layer), net(t.net));
    for (const ArtVia& via : art.vias)
      items_ += fmt::format("  (via (at {}) (size {:g}) (drill {:g}) (layers \"F.Cu\" \"B.Cu\") (net {}))\n",
                            at(via.at_mm), kContactPad_mm, kContactHole_mm, net(via.net));
    for (const ArtPlane& p : art.planes) plane(p);
  }

  [[nodiscard]] std::string text() const {
    std::string all = "(kicad_pcb (version 20211014) (generator triskin)\n  (general (thickness 0.3))\n";
    all += fmt::format("  (paper \"User\" {:.0f} {:.0f})\n", std::ceil(high_mm_.x() + 2 * kPageMargin_mm),
                       std::ceil(high_mm_.y() + 2 * kPageMargin_mm));
    all += fmt::format(
        "  (title_block (title \"{}\") (rev \"{:016x}\") (comment 1 \"A proposal: no such board was built\"))\n",
        island_.part_number, design_.design_id);
    all += std::string(kBoardLayers) + kBoardSetup + "  (net 0 \"\")\n";
    std::vector<std::string> names(nets_.size());
    for (const auto& [name, number] : nets_) names[static_cast<std::size_t>(number - 1)] = name;
    for (std::size_t k = 0; k < names.size(); ++k) all += fmt::format("  (net {} \"{}\")\n", k + 1, names[k]);
    return all + items_ + drawing() + ")\n";
  }

  // Returns the pins of each net: reference and pad.
  [[nodiscard]] const std::map<std::string, std::vector<std::array<std::string, 2>>>& pins() const { return pins_; }
  [[nodiscard]] const std::vector<std::array<std::string, 2>>& components() const { return components_; }

 private:
  int net(const std::string& name) { return nets_.try_emplace(name, static_cast<int>(nets_.size()) + 1).first->second; }
  std::string net_text(const std::string& name) { return fmt::format(" (net {} \"{}\")", net(name), name); }

  [[nodiscard]] std::string at(const Vec2& p) const {
    return fmt::format("{:.6f} {:.6f}", p.x() + kPageMargin_mm, high_mm_.y() - p.y() + kPageMargin_mm);
  }

  void footprint(const ArtFootprint& part) {
    items_ += fmt::format("  (footprint \"Triskin:{}\" (layer \"F.Cu\")\n    (at {} {:.4f})\n    (attr smd)\n",
                          part.name, at(part.pose.center_mm), degrees(part.pose.angle_rad));
    const char* const font = "(effects (font (size 1 1) (thickness 0.15)))";
    items_ += fmt::format("    (fp_text reference \"{}\" (at 0 0) (layer \"F.Fab\") {})\n", part.reference, font);
    items_ += fmt::format("    (fp_text value \"{}\" (at 0 2) (layer \"F.Fab\") {})\n", part.name, font);
    for (const auto& [pad, pad_net] : part.pads) {
      items_ += pad_text(pad, part.pose.angle_rad, pad_net.empty() ? "" : net_text(pad_net));
      auto& pins = pins_[pad_net];
      const std::array<std::string, 2> pin{part.reference, pad.name};
      if (pins.empty() || pins.back() != pin) pins.push_back(pin);  // A contact has two pads of the same name.
    }
    if (part.name == std::string_view(kModuleName)) items_ += module_details(part.pose.angle_rad);
    items_ += "  )\n";
    components_.push_back({part.reference, part.name});
  }

  // The file has the zone and its filling, so that a plot without filling it anew is right as well.
  void plane(const ArtPlane& plane) {
    std::string points;
    for (const Vec2& p : plane.ring_mm) points += fmt::format(" (xy {})", at(p));
    items_ += fmt::format(
        "  (zone (net {}) (net_name \"{}\") (layer \"In1.Cu\") (hatch edge 0.508)\n    (connect_pads yes (clearance "
        "{:g}))\n    (min_thickness 0.025) (filled_areas_thickness no)\n    (fill yes (thermal_gap 0.2) "
        "(thermal_bridge_width 0.2))\n    (polygon (pts{}))\n    (filled_polygon (layer \"In1.Cu\") (pts{}))\n  )\n",
        net(plane.net), plane.net, kClearance_mm, points, points);
  }

  [[nodiscard]] std::string line(const Vec2& from, const Vec2& to, const char* layer, double width_mm) const {
    return fmt::format("  (gr_line (start {}) (end {}) (layer \"{}\") (width {:g}))\n", at(from), at(to), layer,
                       width_mm);
  }
  [[nodiscard]] std::string ring(const std::vector<Vec2>& points) const {
    std::string all;
    for (std::size_t k = 0; k < points.size(); ++k)
      all += line(points[k], points[(k + 1) % points.size()], "Edge.Cuts", 0.05);
    return all;
  }
  [[nodiscard]] std::string words(const std::string& text, const Vec2& place, double angle_rad, double height_mm,
                                  const char* layer) const {
    return fmt::format(
        "  (gr_text \"{}\" (at {} {:.4f}) (layer \"{}\") (effects (font (size {:g} {:g}) (thickness 0.15))))\n", text,
        at(place), degrees(angle_rad), layer, height_mm, height_mm);
  }

  [[nodiscard]] std::string drawing() const {
    std::string all = ring(island_.outline_mm);
    for (const auto& hole : island_.holes_mm) all += ring(hole);
    for (const Fold& fold : island_.folds) {
      all += line(fold.from_mm, fold.to_mm, "User.1", 0.1);
      all +=
          words(fmt::format("{:.0f}° {}", std::abs(degrees(fold.angle_rad)), fold.angle_rad >= 0 ? "away" : "towards"),
                (fold.from_mm + fold.to_mm) / 2.0, text_angle_rad(fold), 1.0, "User.1");
    }
    for (const Slit& slit : island_.slits) all += line(slit.from_mm, slit.to_mm, "User.2", 0.1);
    for (const Mark& mark : island_.marks)
      all += words(mark.text, mark.at_mm, mark.angle_rad, mark.height_mm, "User.3");
    return all;
  }

  const design::Design& design_;
  const FlatIsland& island_;
  Vec2 high_mm_{0, 0};
  std::map<std::string, int> nets_;
  std::map<std::string, std::vector<std::array<std::string, 2>>> pins_;
  std::vector<std::array<std::string, 2>> components_;
  std::string items_;
};

}  // namespace

std::string island_board(const design::Design& design, const sheet::Sides& sides, const FlatIsland& island) {
  return Board(design, sides, island).text();
}

std::string island_netlist(const design::Design& design, const sheet::Sides& sides, const FlatIsland& island) {
  const Board board(design, sides, island);
  std::string text = fmt::format(
      "(export (version \"E\")\n  (design (source \"{}\") (tool \"triskin\"))\n  (components\n", island.part_number);
  for (const auto& [reference, name] : board.components())
    text += fmt::format("    (comp (ref \"{}\") (value \"{}\") (footprint \"Triskin:{}\"))\n", reference, name, name);
  text += "  )\n  (nets\n";
  int code = 0;
  for (const auto& [name, pins] : board.pins()) {
    if (name.empty()) continue;
    text += fmt::format("    (net (code \"{}\") (name \"{}\")", ++code, name);
    for (const auto& [reference, pad] : pins)
      text += fmt::format("\n      (node (ref \"{}\") (pin \"{}\"))", reference, pad);
    text += ")\n";
  }
  return text + "  )\n)\n";
}

std::string module_alone() {
  design::Design design;
  design.name = kModuleName;
  PlacedModule module;
  for (int k = 0; k < 3; ++k) {
    const double angle_rad = std::numbers::pi * (-5.0 / 6.0 + 2.0 / 3.0 * k),
                 from_middle_mm = 2.0 * design::kHeight_mm / 3.0;
    module.corner_mm[static_cast<std::size_t>(k)] = {from_middle_mm * std::cos(angle_rad),
                                                     from_middle_mm * std::sin(angle_rad), 0.0};
  }
  design.layout.modules.push_back(module);
  const sheet::Sides sides = sheet::sides_of(design);
  FlatIsland island = flat_islands(design, sides).front();
  island.part_number = kModuleName;
  return Board(design, sides, island).text();
}

std::string board_project(const std::string& file_name) {
  const nlohmann::json rules = {{"min_clearance", kClearance_mm},
                                {"min_copper_edge_clearance", kEdgeClearance_mm},
                                {"min_hole_clearance", kClearance_mm},
                                {"min_hole_to_hole", 0.25},
                                {"min_through_hole_diameter", kContactHole_mm},
                                {"min_track_width", kNarrowTrack_mm},
                                {"min_via_annular_width", 0.1},
                                {"min_via_diameter", kContactPad_mm}};
  const nlohmann::json net_class = {{"name", "Default"},
                                    {"clearance", kClearance_mm},
                                    {"track_width", kTrack_mm},
                                    {"via_diameter", kContactPad_mm},
                                    {"via_drill", kContactHole_mm}};
  const nlohmann::json project = {{"board", {{"design_settings", {{"rules", rules}, {"meta", {{"version", 2}}}}}}},
                                  {"meta", {{"filename", file_name}, {"version", 1}}},
                                  {"net_settings", {{"classes", {net_class}}, {"meta", {{"version", 2}}}}}};
  return project.dump(2) + "\n";
}

}  // namespace triskin::fabrication
