// SPDX-License-Identifier: GPL-3.0-or-later
#include "module_tracks.hpp"

#include <Eigen/Geometry>
#include <map>
#include <numbers>

#include "net_router.hpp"
#include "triskin/base/index.hpp"

namespace triskin::fabrication {
namespace {

using design::Vec2;

// On a module without patch, line and address every net of the bus, of the chip and of the straps has its own name.
constexpr ModuleSetting kAnyModule{};
constexpr int kBackLayer = kCopperLayers - 1;

FixedCopper copper_of(const ModulePad& pad, int net) {
  FixedCopper copper{.from_mm = pad.at_mm, .to_mm = pad.at_mm, .angle_rad = pad.angle_rad, .net = net};
  switch (pad.layer) {
    case PadLayer::kThrough:
      copper.on.fill(true);
      break;
    case PadLayer::kTouch:
      copper.on.front() = true;
      break;
    case PadLayer::kBack:
      copper.on.back() = true;
      copper.half_size_mm = pad.size_mm / 2.0;
      return copper;
  }
  copper.radius_mm = pad.size_mm.x() / 2.0;
  return copper;
}

FixedCopper line_of(const Vec2& from, const Vec2& to, double width_mm, int layer, int net) {
  FixedCopper copper{.from_mm = from, .to_mm = to, .radius_mm = width_mm / 2.0, .net = net};
  copper.on[at(layer)] = true;
  return copper;
}

class ModuleRoute {
 public:
  ModuleRouting run() {
    for (const ModulePad& pad : module_pads()) add_pad(pad);
    for (std::size_t port = 0; port < layout::kPorts; ++port) add_port(port);
    std::vector<NetPads> nets;
    std::vector<NetKind> kinds(net_number_.size() + 2, NetKind::kDigital);
    for (const auto& [name, number] : net_number_) {
      if (name.find("_CIN") != std::string::npos) kinds[at(number)] = NetKind::kSensor;
      if (name.ends_with("_ACSHIELD")) kinds[at(number)] = NetKind::kShield;
    }
    const RouteGrid grid(copper_, kinds);
    for (const auto& [number, pads] : pads_of_net_) nets.push_back(net_pads(grid, number, pads));
    for (const NetPath& path : route_nets(grid, nets)) add_path(grid, path);
    return std::move(routing_);
  }

 private:
  int number_of(const std::string& net) {
    return net_number_.try_emplace(net, static_cast<int>(net_number_.size()) + 1).first->second;
  }

  void add_pad(const ModulePad& pad) {
    const std::string net = net_of(pad, kAnyModule);
    // A pin without a net keeps all tracks off by a number that no net has.
    const int number = number_of(net.empty() ? "open " + pad.name : net);
    copper_.push_back(copper_of(pad, number));
    if (!net.empty()) pads_of_net_[number].push_back(&pad);
  }

  // Whatever a port is used for, joint or cable, its copper is free of other nets.
  void add_port(std::size_t port) {
    const Eigen::Rotation2Dd turn(2.0 * std::numbers::pi / 3.0 * static_cast<double>(port));
    for (std::size_t net = 0; net < kBusNets; ++net) {
      const int number = number_of(bus_net_name(kAnyModule, net));
      for (const int sign : {-1, 1}) {
        const Vec2 from = contact_at(port, net, sign);
        copper_.push_back(
            line_of(from, from + turn * Vec2(0, -kContacts[net].inset_mm), ring_track_mm(net), kBackLayer, number));
      }
    }
    for (std::size_t pin = 0; pin < kBusNets; ++pin) {
      const int number = number_of(bus_net_name(kAnyModule, kCablePinNets[pin]));
      FixedCopper pad = line_of(turn * cable_pad_at(pin), turn * cable_pad_at(pin), 0.0, kCopperLayers - 1, number);
      pad.half_size_mm = Vec2(kCablePadWidth_mm, kCablePadLength_mm) / 2.0;
      pad.angle_rad = turn.angle();
      copper_.push_back(pad);
      const std::vector<Vec2> track = cable_track(pin);
      for (std::size_t p = 0; p + 1 < track.size(); ++p)
        copper_.push_back(line_of(turn * track[p], turn * track[p + 1], kNarrowTrack_mm, kCopperLayers - 1, number));
    }
  }

  NetPads net_pads(const RouteGrid& grid, int number, const std::vector<const ModulePad*>& pads) {
    NetPads net{.net = number, .start = {}, .pads = {}};
    if (net_of(*pads.front(), kAnyModule).ends_with("_ACSHIELD")) {
      // The plane is everywhere; a hole near the chip's pin reaches it.
      constexpr double kReach_mm = 4.0;
      for (int place = 0; place < grid.nodes_per_layer(); ++place) {
        if (grid.place_mm(place).norm() < kReach_mm) net.start.push_back(kShieldLayer * grid.nodes_per_layer() + place);
      }
    }
    for (const ModulePad* pad : pads) {
      const std::vector<int> nodes = grid.nodes_in(copper_of(*pad, number));
      if (pad->layer == PadLayer::kThrough) {
        net.start.insert(net.start.end(), nodes.begin(), nodes.end());
      } else {
        net.pads.push_back(nodes);
        ends_[number].push_back(pad);
      }
    }
    return net;
  }

  void add_path(const RouteGrid& grid, const NetPath& path) {
    const ModulePad& end = *ends_.at(path.net)[at(path.pad)];
    const int per_layer = grid.nodes_per_layer();
    const auto layer_of = [&](int node) { return static_cast<CopperLayer>(node / per_layer); };
    std::size_t first = 0;
    for (std::size_t k = 1; k < path.nodes.size(); ++k) {
      const int step = path.nodes[k] - path.nodes[k - 1];
      const bool is_hole = layer_of(path.nodes[k]) != layer_of(path.nodes[k - 1]);
      if (is_hole) add_via(end, grid.place_mm(path.nodes[k]));
      const bool goes_on = k + 1 < path.nodes.size() && !is_hole && path.nodes[k + 1] - path.nodes[k] == step;
      if (goes_on) continue;
      if (!is_hole)
        add_track(end, layer_of(path.nodes[k]), grid.place_mm(path.nodes[first]), grid.place_mm(path.nodes[k]));
      first = k;
    }
    add_ends(grid, path, end);
  }

  // A track goes on to the middle of its pads, so that it hangs on them by more than its border.
  void add_ends(const RouteGrid& grid, const NetPath& path, const ModulePad& end) {
    const auto to_middle = [&](int node, const ModulePad& pad) {
      const Vec2 p = grid.place_mm(node);
      if ((p - pad.at_mm).norm() > 1e-6)
        add_track(end, static_cast<CopperLayer>(node / grid.nodes_per_layer()), p, pad.at_mm);
    };
    to_middle(path.nodes.back(), end);
    for (const ModulePad* pad : pads_of_net_.at(path.net)) {
      const FixedCopper copper = copper_of(*pad, path.net);
      const int node = path.nodes.front();
      if (copper.on[at(node / grid.nodes_per_layer())] && copper.distance_mm(grid.place_mm(node)) == 0.0)
        to_middle(node, *pad);
    }
  }

  void add_track(const ModulePad& pad, CopperLayer layer, const Vec2& from, const Vec2& to) {
    routing_.tracks.push_back({pad.name, layer, from, to});
  }
  void add_via(const ModulePad& pad, const Vec2& at_mm) {
    for (const ModuleVia& via : routing_.vias) {
      if ((via.at_mm - at_mm).norm() < 1e-6) return;  // Two paths of one net share it.
    }
    routing_.vias.push_back({pad.name, at_mm});
  }

  std::map<std::string, int> net_number_;
  std::map<int, std::vector<const ModulePad*>> pads_of_net_, ends_;
  std::vector<FixedCopper> copper_;
  ModuleRouting routing_;
};

}  // namespace

const char* copper_layer_name(CopperLayer layer) {
  constexpr std::array<const char*, kCopperLayers> kNames{"F.Cu", "In1.Cu", "In2.Cu", "B.Cu"};
  return kNames.at(at(static_cast<int>(layer)));
}

const ModuleRouting& module_routing() {
  static const ModuleRouting kRouting = ModuleRoute().run();
  return kRouting;
}

}  // namespace triskin::fabrication
