// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/session/bus_budget.hpp"
#include "triskin/session/sample_account.hpp"

namespace triskin::device {

/// Account of one module.
struct ModuleCounts {
  int module = 0;  ///< id in the design
  int patch = 0;
  SampleCounts counts;
  bool slow = false;  ///< its controller took fewer than 0.9 of the samples that the rate says
  int cover = 0;      ///< index among the designs of the stream
  /// True: samples were due and none with data came.
  [[nodiscard]] bool never_heard() const { return counts.expected > 0 && counts.with_data == 0; }
};

/// Account of a module that the controller of another patch read for a time (docs/adoption.md).
/// Beside it the module has its account in StreamReport::modules, of its own controller.
struct AdoptedCounts {
  int module = -1;  ///< id in the design; −1: the design has no module there
  int patch = 0;    ///< patch of the controller that read it
  SampleCounts counts;
  bool now = false;  ///< its samples still arrive
  int cover = 0;     ///< index among the designs of the stream
};

/// What is known of a controller's clock.
struct ClockState {
  int cover = 0;  ///< index among the designs of the stream
  int patch = 0;
  std::uint8_t node = 0;
  double drift_ppm = 0.0;      ///< how much faster the clock of the link runs
  std::uint32_t error_us = 0;  ///< bound of the time of its latest sample; LinkTime::kUnbounded: there is none
  int restarts = 0;            ///< times that its clock began anew or contradicted what was known
};

/// What a reader of the stream got of what was due.
struct StreamReport {
  std::vector<ModuleCounts> modules;   ///< sorted by patch, then by row of the table
  std::vector<AdoptedCounts> adopted;  ///< sorted by patch, then in the order in which they were adopted
  SampleCounts total;
  std::uint64_t lost_bus = 0;      ///< part of total.on_the_way: between controller and this computer
  std::uint64_t lost_host = 0;     ///< the rest of it: this computer threw them away, or let its lease lapse
  std::vector<int> never_heard;    ///< modules without any sample that has data
  std::vector<int> slow;           ///< modules that were sampled less often than the rate says
  std::vector<int> starved;        ///< patches that lost over 1 % of their samples because the bus had no room
  std::vector<int> silent;         ///< patches whose controller was away
  std::vector<ClockState> clocks;  ///< sorted by node address
  int lapses = 0;                  ///< number of times that this computer renewed its lease too late
  BusBudget budget;
  /// True: every sample that was due came, with data from every module.
  [[nodiscard]] bool complete() const {
    return total.lost() == 0 && never_heard.empty() && slow.empty() && silent.empty();
  }
};

/// Fills everything that follows from `modules` and `adopted`. `thrown_away`: frames that this computer threw away.
void sum_up(StreamReport& report, std::uint64_t thrown_away);

/// Text for a person: the counts in one sentence, then one for each thing that is missing, with the remedy.
[[nodiscard]] std::vector<std::string> sentences(const StreamReport& report);

}  // namespace triskin::device
