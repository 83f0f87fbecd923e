// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "triskin/link/link.hpp"

namespace triskin::session {

/// A controller wants to send so many samples.
struct StreamDemand {
  std::uint8_t node = 0;
  std::size_t modules = 0;        ///< The controller's table has this many modules.
  std::uint64_t interval_us = 0;  ///< Two samples of a module are nominally this far apart.
};

struct WireLoad {
  std::vector<std::uint8_t> nodes;
  std::size_t modules = 0;
  /// The load if every sample is streamed is a fraction of the wire's capacity; 0 means that its rate is unknown.
  double full = 0.0;
};

/// The samples of a stream are fitted into the wires of a link with this result.
struct BusBudget {
  std::vector<WireLoad> wires;
  int every = 1;      ///< Each n-th sample is streamed.
  double full = 0.0;  ///< Streaming every sample would load the busiest wire by this fraction.
  double load = 0.0;  ///< Streaming each n-th sample loads the busiest wire by this fraction.
  bool fits = true;   ///< True means that the load is at most wire::kStreamShare.
  /// Two samples of a module are at least this far apart, so that all modules get an equal share; 0 means that all
  /// samples fit.
  std::uint64_t pace_us = 0;
};

/// Converters run up to 4 % faster than their nominal rate, so the load is computed with this factor.
inline constexpr double kFastestClock = 1.04;

/// Returns the smallest n ≥ 1 for which each n-th sample fits a wire that all samples would load by `full`, a
/// fraction of its capacity; at most 10⁶.
[[nodiscard]] int min_every(double full);

/// Computes the budget for each n-th sample. If `every` is 0, it uses the smallest 1 … 255 that fits, or 255 when
/// none does.
[[nodiscard]] BusBudget make_budget(const link::Link& link, std::span<const StreamDemand> demands, int every);

/// Returns one sentence that says how much of the request the wire carries and what to do about it.
[[nodiscard]] std::string describe(const BusBudget& budget);

}  // namespace triskin::session
