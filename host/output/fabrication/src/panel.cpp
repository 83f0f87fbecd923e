// SPDX-License-Identifier: GPL-3.0-or-later
#include "panel.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "gerber.hpp"
#include "kicad_text.hpp"
#include "triskin/base/csv_field.hpp"

namespace triskin::fabrication {
namespace {

using design::Vec2;

constexpr double kFrame_mm = 7.0, kCutWidth_mm = 0.05, kTab_mm = 1.0;
constexpr double kFiducial_mm = 1.0, kFiducialOpening_mm = 2.0, kTooling_mm = 2.0;
constexpr double kMaskMargin_mm = 0.05;       // The photo-imageable mask of the back opens this much beyond a pad.
constexpr std::size_t kMaxDesignators = 200;  // JLCPCB reads rows of a bill up to this.

std::string module_designator(const std::string& reference, const char* part) {
  return fmt::format("{}_{}", reference, part);
}

// Layers of the panel; those that an assembly house looks at come last.
struct Layers {
  Gerber copper[4] = {Gerber("Copper,L1,Top"), Gerber("Copper,L2,Inr"), Gerber("Copper,L3,Inr"),
                      Gerber("Copper,L4,Bot")};
  Gerber mask_top{"Soldermask,Top"}, mask_bottom{"Soldermask,Bot"}, paste{"Paste,Bot"}, silk{"Legend,Bot"};
  Gerber profile{"Profile,NP"};
  std::vector<Vec2> plated, tooling;
};

class PanelDrawing {
 public:
  PanelDrawing(const std::vector<FlatIsland>& islands, const std::vector<BoardArt>& art, const Nesting& nesting,
               int sheet)
      : islands_(islands), art_(art), nesting_(nesting), sheet_(sheet) {
    Vec2 low = Vec2::Constant(1e9), high = -low;
    for (const NestedIsland& place : nesting.places) {
      if (place.sheet != sheet) continue;
      for (const Vec2& p : on_sheet(islands[place.island], place).outline_mm) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
    }
    origin_ = low - Vec2::Constant(kFrame_mm);
    size_ = high - low + Vec2::Constant(2.0 * kFrame_mm);
  }

  Panel run() {
    add_frame();
    for (const NestedIsland& place : nesting_.places) {
      if (place.sheet != sheet_) continue;
      add_outline(islands_[place.island], place);
      add_art(art_[place.island], {place.shift_mm - origin_, place.angle_rad});
    }
    return files();
  }

 private:
  void add_frame() {
    const Vec2 w(size_.x(), 0), h(0, size_.y());
    const std::array<Vec2, 4> corner{Vec2(0, 0), w, size_, h};
    for (std::size_t k = 0; k < 4; ++k) cut(corner[k], corner[(k + 1) % 4]);
    constexpr double kFromEdge_mm = 3.5, kBeside_mm = 5.0;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec2 inward((k == 0 || k == 3) ? 1 : -1, k < 2 ? 1 : -1);
      layers_.tooling.emplace_back(corner[k] + kFromEdge_mm * inward);
      if (k == 2) continue;  // Three fiducials tell how the panel lies.
      const Vec2 at = corner[k] + kFromEdge_mm * inward + Vec2(kBeside_mm * inward.x(), 0);
      for (Gerber* copper : {&layers_.copper[0], &layers_.copper[3]})
        copper->flash(at, kFiducial_mm, "FiducialPad,Panel", "");
      for (Gerber* mask : {&layers_.mask_top, &layers_.mask_bottom})
        mask->flash(at, kFiducialOpening_mm, "Other,Fiducial", "");
    }
  }

  void cut(const Vec2& from, const Vec2& to) { layers_.profile.line(from, to, kCutWidth_mm, "Profile", ""); }

  // Every third long side of the outline keeps a tab in its middle, at least three of them if there are as many sides.
  void add_outline(const FlatIsland& island, const NestedIsland& place) {
    const FlatIsland here = on_sheet(island, place);
    const auto& ring = here.outline_mm;
    constexpr double kLong_mm = 10.0;
    constexpr int kEvery = 3;
    int sides = 0;
    for (std::size_t k = 0; k < ring.size(); ++k) sides += (ring[(k + 1) % ring.size()] - ring[k]).norm() > kLong_mm;
    int side = 0;
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 a = ring[k] - origin_, b = ring[(k + 1) % ring.size()] - origin_, middle = (a + b) / 2.0;
      const bool is_long = (b - a).norm() > kLong_mm;
      const bool has_tab = is_long && (side % kEvery == 0 || sides < 2 * kEvery);
      side += is_long;
      if (!has_tab) {
        cut(a, b);
        continue;
      }
      const Vec2 half = (b - a).normalized() * kTab_mm / 2.0;
      cut(a, middle - half);
      cut(middle + half, b);
    }
    for (const auto& hole : here.holes_mm) {
      for (std::size_t k = 0; k < hole.size(); ++k) cut(hole[k] - origin_, hole[(k + 1) % hole.size()] - origin_);
    }
    for (const Slit& slit : here.slits) cut(slit.from_mm - origin_, slit.to_mm - origin_);
  }

  void add_art(const BoardArt& art, const Pose& island) {
    for (const ArtTrack& t : art.tracks)
      layers_.copper[static_cast<int>(t.layer)].line(island * t.from_mm, island * t.to_mm, t.width_mm, "Conductor",
                                                     t.net);
    for (const ArtVia& via : art.vias) add_hole(island * via.at_mm, "ViaPad", via.net);
    for (const ArtPlane& plane : art.planes) {
      Ring ring;
      for (const Vec2& p : plane.ring_mm) ring.push_back(island * p);
      layers_.copper[static_cast<int>(CopperLayer::kInner1)].region(ring, plane.net);
    }
    for (const ArtFootprint& footprint : art.footprints) add_footprint(footprint, island * footprint.pose);
  }

  void add_hole(const Vec2& at, const char* use, const std::string& net) {
    for (Gerber& copper : layers_.copper) copper.flash(at, kContactPad_mm, use, net);
    layers_.plated.push_back(at);
  }

  void add_footprint(const ArtFootprint& footprint, const Pose& pose) {
    for (const auto& [pad, net] : footprint.pads) add_pad(pad, net, pose);
    if (footprint.name != std::string_view(kModuleName)) return;
    for (const ModulePad& w : paste_windows())
      layers_.paste.flash_rectangle(pose * w.at_mm, w.size_mm, pose.angle_rad, "Material", "");
    for (const SilkLine& l : module_silk())
      layers_.silk.line(pose * l.from_mm, pose * l.to_mm, kSilk_mm, "Other,Legend", "");
    for (const ModulePart& part : module_parts()) add_part(footprint.reference, part, pose);
  }

  void add_pad(const ModulePad& pad, const std::string& net, const Pose& pose) {
    const Vec2 at = pose * pad.at_mm;
    switch (pad.layer) {
      case PadLayer::kThrough:
        return add_hole(at, "ViaPad", net);
      case PadLayer::kTouch:
        // The coverlay of the touch side stays closed over the taxels.
        return layers_.copper[0].flash(at, pad.size_mm.x(), "Other,Electrode", net);
      case PadLayer::kBack:
        break;
    }
    const double angle_rad = pose.angle_rad + pad.angle_rad;
    layers_.copper[3].flash_rectangle(at, pad.size_mm, angle_rad, "SMDPad,CuDef", net);
    layers_.mask_bottom.flash_rectangle(at, pad.size_mm + Vec2::Constant(2.0 * kMaskMargin_mm), angle_rad, "Material",
                                        "");
    if (has_paste(pad)) layers_.paste.flash_rectangle(at, pad.size_mm, angle_rad, "Material", "");
  }

  // JLCPCB's rule for parts on the back: counter-clockwise as seen from the back, places not mirrored.
  void add_part(const std::string& reference, const ModulePart& part, const Pose& pose) {
    const std::string designator = module_designator(reference, part.designator);
    const Vec2 at = pose * part.at_mm;
    double rotation_deg = std::fmod((part.angle_rad - pose.angle_rad) * 180.0 / std::numbers::pi, 360.0);
    if (rotation_deg < 0.0) rotation_deg += 360.0;
    if (rotation_deg > 359.9995) rotation_deg = 0.0;
    positions_ += fmt::format("{},{:.4f},{:.4f},Bottom,{:.3f}\r\n", designator, at.x(), at.y(), rotation_deg);
    bill_[&part].push_back(designator);
  }

  [[nodiscard]] std::string bill() const {
    std::string text = "Comment,Designator,Footprint,JLCPCB Part #,Manufacturer,Manufacturer Part Number,Quantity\r\n";
    for (const auto& [part, designators] : bill_) {
      for (std::size_t first = 0; first < designators.size(); first += kMaxDesignators) {
        const std::size_t end = std::min(designators.size(), first + kMaxDesignators);
        std::string row;
        for (std::size_t k = first; k < end; ++k) row += (k > first ? "," : "") + designators[k];
        text += fmt::format("{},{},{},,{},{},{}\r\n", csv_field(part->value), csv_field(row), csv_field(part->package),
                            csv_field(part->manufacturer), part->order_number, end - first);
      }
    }
    return text;
  }

  [[nodiscard]] std::string notes() const {
    return fmt::format(
        "{} x {} mm, seen from the touch side (top). A proposal: no such board was built.\n"
        "Flexible board, four copper layers of 18 um, three dielectrics of polyimide of 50 um, 0.27 mm in all; ENIG.\n"
        "Tracks and gaps 0.1 mm; plated holes 0.2 mm in pads of 0.4 mm; no hole is filled.\n"
        "Top: polyimide coverlay, open at the fiducials only; taxels stay covered.\n"
        "Bottom: flexible photo-imageable solder mask, webs of 0.1 mm and more.\n"
        "Inner layer 2 is a plane that the converter drives (ACSHIELD), one for each module; it is no ground.\n"
        "Profile: frame, and each island with gaps of {} mm in its outline as tabs; lines of no area are slits.\n"
        "No stiffener: electrodes cover one side and parts the other.\n"
        "Cables (ten ways, 1.0 mm) are soldered to the pads of the back by hand after assembly.\n",
        round2(size_.x()), round2(size_.y()), kTab_mm);
  }
  static double round2(double mm) { return std::round(mm * 100.0) / 100.0; }

  [[nodiscard]] Panel files() const {
    Panel panel;
    panel.name = fmt::format("panel_{}", sheet_ + 1);
    panel.size_mm = size_;
    const auto named = [&](const char* layer, const Gerber& gerber) {
      return NamedFile{fmt::format("{}-{}.gbr", panel.name, layer), gerber.text()};
    };
    const std::array<const char*, 4> copper{"F_Cu", "In1_Cu", "In2_Cu", "B_Cu"};
    for (std::size_t k = 0; k < copper.size(); ++k) panel.board.push_back(named(copper[k], layers_.copper[k]));
    panel.board.push_back(named("F_Mask", layers_.mask_top));
    const std::vector<NamedFile> both{named("B_Mask", layers_.mask_bottom), named("B_Paste", layers_.paste),
                                      named("B_Silkscreen", layers_.silk), named("Edge_Cuts", layers_.profile)};
    panel.board.insert(panel.board.end(), both.begin(), both.end());
    panel.board.push_back({panel.name + "-PTH.drl", excellon("Plated,1,4,PTH", kContactHole_mm, layers_.plated)});
    panel.board.push_back({panel.name + "-NPTH.drl", excellon("NonPlated,1,4,NPTH", kTooling_mm, layers_.tooling)});
    panel.board.push_back({panel.name + "-notes.txt", notes()});
    panel.assembly.push_back({panel.name + "-bom.csv", bill()});
    panel.assembly.push_back({panel.name + "-cpl.csv", "Designator,Mid X,Mid Y,Layer,Rotation\r\n" + positions_});
    panel.assembly.push_back(named("B_Cu", layers_.copper[3]));
    panel.assembly.insert(panel.assembly.end(), both.begin(), both.end());
    return panel;
  }

  struct ByDesignator {
    bool operator()(const ModulePart* a, const ModulePart* b) const {
      return std::string_view(a->designator) > std::string_view(b->designator);  // U1 first
    }
  };

  const std::vector<FlatIsland>& islands_;
  const std::vector<BoardArt>& art_;
  const Nesting& nesting_;
  int sheet_;
  Vec2 origin_, size_;
  Layers layers_;
  std::string positions_;
  std::map<const ModulePart*, std::vector<std::string>, ByDesignator> bill_;
};

}  // namespace

Panel panel_of(const std::vector<FlatIsland>& islands, const std::vector<BoardArt>& art, const Nesting& nesting,
               int sheet) {
  return PanelDrawing(islands, art, nesting, sheet).run();
}

}  // namespace triskin::fabrication
