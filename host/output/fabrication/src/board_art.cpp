// SPDX-License-Identifier: GPL-3.0-or-later
#include "board_art.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>

#include "kicad_text.hpp"
#include "shield_plane.hpp"
#include "triskin/base/error.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/design/module_side.hpp"

namespace triskin::fabrication {
namespace {

using design::Vec2;

constexpr double kPortTurn_rad = 2.0 * std::numbers::pi / 3.0;

// Where a module lies on its island, and how the side of its port A is turned there.
Pose pose_of(const FlatIsland& island, const design::PlacedModule& module, int rotation) {
  const Vec2 a = corner_on(island, module.tile, rotation), b = corner_on(island, module.tile, (rotation + 1) % 3);
  const Vec2 c = corner_on(island, module.tile, (rotation + 2) % 3);
  return {(a + b + c) / 3.0, std::atan2((b - a).y(), (b - a).x())};
}

class Artist {
 public:
  Artist(const design::Design& design, const sheet::Sides& sides, const FlatIsland& island)
      : design_(design), sides_(sides), island_(island), wiring_(design::wiring_of(design)) {}

  BoardArt run() {
    for (const int id : island_.modules) add_module(id);
    for (const int id : island_.modules) add_cables(id);
    return std::move(art_);
  }

 private:
  void track(const Vec2& from, const Vec2& to, double width_mm, CopperLayer layer, const std::string& net) {
    art_.tracks.push_back({from, to, width_mm, layer, net});
  }

  [[nodiscard]] Pose pose_of_module(int id) const {
    const auto k = static_cast<std::size_t>(id);
    return pose_of(island_, design_.layout.modules[k], wiring_[k].patch < 0 ? 0 : wiring_[k].routed.rotation);
  }

  void add_module(int id) {
    const ModuleSetting setting = setting_of(design_, wiring_, layout::ModuleId{id});
    const Pose pose = pose_of_module(id);
    ArtFootprint module{kModuleName, fmt::format("M{}", design::number_of(design_, id)), pose, {}};
    std::map<std::string, std::string> net_of_pad;
    for (const ModulePad& pad : module_pads()) {
      module.pads.emplace_back(pad, net_of(pad, setting));
      net_of_pad.emplace(module.pads.back().first.name, module.pads.back().second);
    }
    art_.footprints.push_back(std::move(module));
    for (std::size_t k = 0; k < kBusNets; ++k) {
      const auto ring = ring_of(k, island_.corner_cut_mm);
      for (std::size_t p = 0; p < ring.size(); ++p)
        track(pose * ring[p], pose * ring[(p + 1) % ring.size()], ring_track_mm(k), CopperLayer::kInner2,
              bus_net_name(setting, k));
    }
    for (const Strap& strap : straps()) {
      if (is_closed(strap, setting))
        track(pose * strap.at_mm[0], pose * strap.at_mm[1], kStrapTrack_mm, CopperLayer::kBack,
              net_of_pad.at(strap.name + ".1"));
    }
    for (const ModuleTrack& t : module_routing().tracks)
      track(pose * t.from_mm, pose * t.to_mm, kNarrowTrack_mm, t.layer, net_of_pad.at(t.pad));
    for (const ModuleVia& via : module_routing().vias) art_.vias.push_back({pose * via.at_mm, net_of_pad.at(via.pad)});
    for (Ring& ring : shield_plane(pose.center_mm, pose.angle_rad))
      art_.planes.push_back({std::move(ring), net_of_pad.at(kShieldPin)});
    add_joints(id, setting, pose);
  }

  // Straight tracks over every kept fold, from the lower module. A contact at +x meets the other's at −x.
  void add_joints(int id, const ModuleSetting& setting, const Pose& pose) {
    for (int s = 0; s < 3; ++s) {
      const sheet::Side& side = sides_.of[static_cast<std::size_t>(id)][static_cast<std::size_t>(s)];
      if (side.kind != sheet::SideKind::kKept || side.other < id) continue;
      const std::size_t port = port_at(id, s);
      const Vec2 outward = rotated({0, -1}, kPortTurn_rad * static_cast<double>(port));
      for (std::size_t k = 0; k < kBusNets; ++k) {
        for (const int sign : {-1, 1}) {
          const Vec2 from = contact_at(port, k, sign);
          track(pose * from, pose * (from + 2.0 * kContacts[k].inset_mm * outward), ring_track_mm(k),
                CopperLayer::kBack, bus_net_name(setting, k));
        }
      }
    }
  }

  [[nodiscard]] std::size_t port_at(int id, int side) const {
    const auto& wired = wiring_[static_cast<std::size_t>(id)];
    return static_cast<std::size_t>(design::port_at_side(side, wired.patch < 0 ? 0 : wired.routed.rotation));
  }

  // A cable at a port belongs to a controller, or is one end of a jumper.
  void add_cables(int id) {
    for (int s = 0; s < 3; ++s) {
      const sheet::Side& side = sides_.of[static_cast<std::size_t>(id)][static_cast<std::size_t>(s)];
      if (side.cable) add_cable(fmt::format("C{}", wiring_[static_cast<std::size_t>(id)].patch), id, port_at(id, s));
      if (side.jumper >= 0) {
        const design::Jumper& jumper = design_.layout.jumpers[static_cast<std::size_t>(side.jumper)];
        add_cable(fmt::format("{}_M{}", design::jumper_name(design_, jumper), design::number_of(design_, id)), id,
                  port_at(id, s));
      }
    }
  }

  void add_cable(const std::string& reference, int id, std::size_t port) {
    const ModuleSetting setting = setting_of(design_, wiring_, layout::ModuleId{id});
    Pose pose = pose_of_module(id);
    pose.angle_rad += kPortTurn_rad * static_cast<double>(port);
    ArtFootprint cable{kCableName, reference, pose, {}};
    for (const ModulePad& pad : cable_pads())
      cable.pads.emplace_back(pad, bus_net_name(setting, kCablePinNets[cable.pads.size()]));
    art_.footprints.push_back(std::move(cable));
    for (std::size_t pin = 0; pin < kBusNets; ++pin) {
      const auto points = cable_track(pin);
      for (std::size_t p = 0; p + 1 < points.size(); ++p)
        track(pose * points[p], pose * points[p + 1], kNarrowTrack_mm, CopperLayer::kBack,
              bus_net_name(setting, kCablePinNets[pin]));
    }
  }

  const design::Design& design_;
  const sheet::Sides& sides_;
  const FlatIsland& island_;
  std::vector<design::ModuleWiring> wiring_;
  BoardArt art_;
};

}  // namespace

BoardArt board_art(const design::Design& design, const sheet::Sides& sides, const FlatIsland& island) {
  if (design.layout.corner_cut_mm > kMaxBoardCornerCut_mm)
    throw InputError(fmt::format(
        "corners are cut by {} mm, and beyond {} mm the pads of three taxels lie over the edge: boards are left out; "
        "make the design with a smaller --corner-cut-mm, or write the other files with --only",
        design.layout.corner_cut_mm, kMaxBoardCornerCut_mm));
  return Artist(design, sides, island).run();
}

}  // namespace triskin::fabrication
