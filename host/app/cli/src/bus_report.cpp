// SPDX-License-Identifier: GPL-3.0-or-later
#include "bus_report.hpp"

#include <fmt/format.h>

#include "triskin/base/counted.hpp"
#include "triskin/session/bus_budget.hpp"
#include "triskin/wire/bus_load.hpp"
#include "triskin/wire/sampling.hpp"

namespace triskin::cli {

namespace {

// Returns the load of one bus by every sample of the full stream at the controllers' fastest clock.
double full_load(std::size_t modules) {
  return session::kFastestClock * wire::stream_load(modules, wire::full_sample_ns(wire::kControllerRates),
                                                    wire::sequence_us(wire::Decimation::k256));
}

}  // namespace

void add_bus_keys(std::size_t modules, Output& output) {
  constexpr std::uint64_t kIcubPeriod_us = 50'000;
  constexpr wire::BitRates kClassic{wire::kControllerRates.nominal, 0};
  const double can_fd = full_load(modules);
  output.result["bus"] = {{"can_fd", can_fd},
                          {"every", session::min_every(can_fd)},
                          {"icub", wire::stream_load(modules, wire::icub_sample_ns(kClassic), kIcubPeriod_us)}};
}

void report_bus(std::size_t modules, Output& output) {
  add_bus_keys(modules, output);
  const double load = full_load(modules);
  const int every = session::min_every(load);
  if (every == 1) return;
  output.say(fmt::format(
      "every sample of all {} is {:.0f} % of one bus with 1 and 2 Mbit/s: one sample in {} fits, or {} carry all",
      counted(modules, "module"), 100.0 * load, every, counted(every, "bus")));
}

}  // namespace triskin::cli
