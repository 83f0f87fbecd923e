// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "support/strip_design.hpp"
#include "triskin/connect/open_bus.hpp"
#include "triskin/hardware/sim_link.hpp"
#include "triskin/link/touch_actuator.hpp"
#include "triskin/robot/edit.hpp"
#include "triskin/robot/site.hpp"
#include "triskin/session/bus.hpp"

namespace triskin::test {

/// Makes a robot without covers; its buses are simulated.
inline robot::Assembly bare_robot(int buses) {
  robot::Assembly a;
  a.file = "robot.json";
  a.robot.name = "robot";
  for (int b = 0; b < buses; ++b) a.robot.buses.push_back(robot::parse_bus("bus" + std::to_string(b) + "=sim"));
  return a;
}

/// Adds a strip of `modules`, `per_patch` to a controller, on bus `bus`.
inline void add_strip(robot::Assembly& a, const std::string& name, int bus, int modules, int per_patch) {
  a.designs.push_back(strip(modules, per_patch));
  robot::CoverEntry cover;
  cover.name = name;
  cover.bus = a.robot.buses[static_cast<std::size_t>(bus)].name;
  cover.design = name + ".json";
  a.robot.covers.push_back(cover);
  robot::seat(a.robot, a.robot.covers.back(), a.designs.back());
}

/// Simulates one bus of a robot, whose boards keep their flash in `folder` (empty: in memory). Their serial numbers
/// ascend with the node addresses, or are drawn from `board_seed`.
class SimulatedBus {
 public:
  explicit SimulatedBus(const robot::BusConfig& site, const std::filesystem::path& folder = {},
                        std::uint64_t board_seed = 0)
      : site_(site), link_(connect::scene_of(site, nullptr, false, board_seed).scene, folder), bus_(link_) {}

  [[nodiscard]] session::Bus& bus() { return bus_; }
  [[nodiscard]] hardware::SimLink& link() { return link_; }
  [[nodiscard]] hardware::VirtualSkin& skin() { return link_.skin(); }
  deploy::FlashResult flash(std::size_t cover, const deploy::FlashOptions& options = {}) {
    const robot::CoverConfig& c = site_.covers[cover];
    return deploy::flash(bus_, c.design, robot::flash_options(site_, c, options));
  }
  /// Returns the flash operations of every controller, by node address.
  [[nodiscard]] std::vector<std::uint64_t> operations() {
    std::vector<std::uint64_t> counts(128);
    for (std::size_t p = 0; p < skin().controllers(); ++p)
      counts[skin().scene().design.node_addresses[p]] = skin().flash(p).operations();
    return counts;
  }
  /// Waits until the controllers have found and stored the offsets of their converters, after which they write nothing.
  void settle() { bus_.listen(bus_.now_us() + 3'000'000); }

 private:
  const robot::BusConfig& site_;
  hardware::SimLink link_;
  session::Bus bus_;
};

}  // namespace triskin::test
