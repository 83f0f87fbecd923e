// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "triskin/session/bus_budget.hpp"
#include "triskin/wire/sampling.hpp"

namespace triskin::device {

/// How the full stream is read.
struct StreamOptions {
  /// How many readings a converter adds up: 36.9, 18.4 or 9.2 ms a sample. Empty: as the controllers are set. They keep
  /// it until they are set anew or lose power.
  std::optional<wire::Decimation> decimation;
  /// When the converters are read; empty: as the controllers are set.
  std::optional<wire::SamplingTiming> timing;
  int every = 0;  ///< each n-th sample, 1 … 255; 0: the smallest n that fits the bus
  /// Controllers of other designs on the same bus. A lease is for all that hear it, so they stream too and count in the
  /// budget; their samples are ignored. Interval 0: that of the default sampling.
  std::vector<StreamDemand> neighbours;
  bool overload = false;  ///< streams `every` also where it does not fit; every module then gets an equal share
  /// Called with one sentence when a controller falls silent, when it speaks again, and when another n-th sample was
  /// chosen than every one. May be empty.
  std::function<void(const std::string&)> say;
};

}  // namespace triskin::device
