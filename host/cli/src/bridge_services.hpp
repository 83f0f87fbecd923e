// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "triskin/bridge/services.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/stream.hpp"
#include "triskin/skin/touch_map.hpp"

namespace triskin::cli {

/// Serves /skin/PART/tare, reroute and identify of one cover on one bus, beside its stream. A failure of a controller
/// is an answer, and the stream goes on. Threads: that of the bus.
class CoverServices {
 public:
  /// `domain`, `design` and `touches` outlive it. Throws DeviceError.
  CoverServices(bridge::Domain& domain, const std::string& part, const design::Design& design,
                device::TouchMap& touches);
  /// Call it for each sample that `touches` has received.
  void add(const device::ModuleSample& frame);
  /// Does what was asked since the last call; talks to controllers. Throws DeviceError when DDS fails.
  void step(device::Bus& bus);

 private:
  void step_tare(std::uint64_t now_us);
  [[nodiscard]] bridge::Reroute::Answer reroute(device::Bus& bus, std::int32_t patch) const;
  [[nodiscard]] bridge::Identify::Answer identify(device::Bus& bus) const;

  const design::Design& design_;
  device::TouchMap& touches_;
  bridge::Service<bridge::Tare> tare_;
  bridge::Service<bridge::Reroute> reroute_;
  bridge::Service<bridge::Identify> identify_;
  std::vector<bridge::RequestId> taring_;  // who waits for it
  std::uint64_t tare_begun_us_ = 0;
  std::vector<std::uint16_t> valid_since_tare_;  // Indexed by module.
};

}  // namespace triskin::cli
