// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "triskin/link/link.hpp"

namespace triskin::device {

/// What one controller wants to send.
struct StreamDemand {
  std::uint8_t node = 0;          ///< It is the node address.
  std::size_t modules = 0;        ///< Its table has so many modules.
  std::uint64_t interval_us = 0;  ///< Two samples of a module are nominally this far apart.
};

/// Load of one wire.
struct WireLoad {
  std::vector<std::uint8_t> nodes;
  std::size_t modules = 0;
  /// It is the load if every sample is streamed, 1 being all of the wire; 0 means that the wire's rate is unknown.
  double full = 0.0;
};

/// How the samples of a stream fit the wires of a link.
struct BusBudget {
  std::vector<WireLoad> wires;
  int every = 1;      ///< Each n-th sample is streamed.
  double full = 0.0;  ///< It is the largest load of a wire if every sample is streamed.
  double load = 0.0;  ///< It is the same load if only each n-th sample is streamed.
  bool fits = true;   ///< The load is at most wire::kStreamShare.
  /// Two samples of a module are at least this far apart, so that all modules get an equal share; 0 means that all fit.
  std::uint64_t pace_us = 0;
};

/// Samples as the largest part of a wire: converters run up to 4 % faster than their rate.
inline constexpr double kFastestClock = 1.04;

/// The smallest n ≥ 1 whose n-th samples fit a wire that all samples would load by `full`, 1 = all; at most 10⁶.
[[nodiscard]] int min_every(double full);

/// Budget of each n-th sample. `every` 0: the smallest 1 … 255 that fits, 255 when none does.
[[nodiscard]] BusBudget make_budget(const Link& link, std::span<const StreamDemand> demands, int every);

/// One sentence: what the wire carries of what was asked, and what to do about it.
[[nodiscard]] std::string describe(const BusBudget& budget);

}  // namespace triskin::device
