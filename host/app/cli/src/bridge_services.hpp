// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "triskin/bridge/services.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/skin/live_cover.hpp"

namespace triskin::cli {

/// Serves skin/PART/tare, reroute and identify of one cover on one bus, beside its stream. If a controller fails, the
/// answer says so and the stream continues. Use it in the thread of the bus.
class CoverServices {
 public:
  /// `base` is "skin/PART". `domain` and `cover` must outlive it. Throws DeviceError.
  CoverServices(bridge::Domain& domain, const std::string& base, skin::LiveCover& cover);
  /// Handles the requests since the last call and talks to controllers. Throws DeviceError when DDS fails.
  void step(session::Bus& bus);

 private:
  void step_tare(std::uint64_t now_us);
  [[nodiscard]] bridge::Reroute::Answer reroute(session::Bus& bus, std::int32_t patch) const;
  [[nodiscard]] bridge::Identify::Answer identify(session::Bus& bus) const;

  skin::LiveCover& cover_;
  bridge::Service<bridge::Tare> tare_;
  bridge::Service<bridge::Reroute> reroute_;
  bridge::Service<bridge::Identify> identify_;
  std::vector<bridge::RequestId> taring_;  // These clients wait for the running tare.
};

}  // namespace triskin::cli
