// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/bus_budget.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "triskin/base/counted.hpp"
#include "triskin/wire/bus_load.hpp"

namespace triskin::session {
namespace {

constexpr int kMaxEvery = 255;

double load_of(const link::Link& link, const StreamDemand& d) {
  return kFastestClock * wire::stream_load(d.modules, link.sample_ns(d.node), d.interval_us);
}

// Returns the time that one sample of each module takes when all modules share the wire equally.
std::uint64_t share_us(const link::Link& link, const WireLoad& wire) {
  const double round_ns = static_cast<double>(wire.modules * link.sample_ns(wire.nodes.front()));
  return static_cast<std::uint64_t>(std::ceil(round_ns / (1000.0 * wire::kStreamShare)));
}

}  // namespace

int min_every(double full) {
  return std::max(1, static_cast<int>(std::ceil(std::min(1e6, full / wire::kStreamShare) - 1e-9)));
}

BusBudget make_budget(const link::Link& link, std::span<const StreamDemand> demands, int every) {
  std::map<int, WireLoad> wires;
  for (const StreamDemand& d : demands) {
    WireLoad& wire = wires[link.wire_of(d.node)];
    wire.nodes.push_back(d.node);
    wire.modules += d.modules;
    wire.full += load_of(link, d);
  }
  BusBudget b;
  for (auto& [number, wire] : wires) b.wires.push_back(std::move(wire));
  for (const WireLoad& wire : b.wires) b.full = std::max(b.full, wire.full);
  const int needed = min_every(b.full);
  b.every = every > 0 ? every : std::min(needed, kMaxEvery);
  b.load = b.full / b.every;
  b.fits = b.every >= needed;
  for (const WireLoad& wire : b.wires) {
    if (wire.full / b.every > wire::kStreamShare) b.pace_us = std::max(b.pace_us, share_us(link, wire));
  }
  return b;
}

std::string describe(const BusBudget& b) {
  const auto fullest = std::ranges::max_element(b.wires, {}, &WireLoad::full);
  if (fullest == b.wires.end() || b.full <= 0.0) return "the load of the bus is not known";
  const std::string what = b.every == 1 ? std::string("every sample") : fmt::format("one sample in {}", b.every);
  std::string text = fmt::format("{} of {} on {} is {:.0f} % of the bus", what, counted(fullest->modules, "module"),
                                 counted(fullest->nodes.size(), "controller"), 100.0 * b.load);
  if (!b.fits) {
    text += fmt::format(", {:.0f} % fit; use --every {} or more, a higher data bit rate, or a second bus",
                        100.0 * wire::kStreamShare, min_every(b.full));
  }
  return text;
}

}  // namespace triskin::session
