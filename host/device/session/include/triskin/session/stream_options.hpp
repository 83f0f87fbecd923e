// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "triskin/session/bus_budget.hpp"
#include "triskin/wire/sampling.hpp"

namespace triskin::session {

struct StreamOptions {
  /// A converter adds up this many readings, which takes 36.9, 18.4 or 9.2 ms per sample. If empty, the controllers
  /// keep their setting. They keep a new one until the next change or power-down.
  std::optional<wire::Decimation> decimation;
  /// Selects when the converters are read; if empty, the controllers keep their setting.
  std::optional<wire::SamplingTiming> timing;
  int every = 0;  ///< Each n-th sample is sent, 1 … 255; 0 selects the smallest n that fits the bus.
  /// The neighbours are controllers of other designs on the same bus. Every controller that hears the lease streams, so
  /// these count in the budget, but their samples are ignored. An interval of 0 means that of the default sampling.
  std::vector<StreamDemand> neighbours;
  /// True streams each n-th sample even if it does not fit; every module then gets an equal share.
  bool overload = false;
  /// Called with one sentence when a controller falls silent, when it answers again, and when not every sample is read
  /// because of the bus. May be empty.
  std::function<void(const std::string&)> say;
};

}  // namespace triskin::session
