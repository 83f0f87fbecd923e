// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/session/bus_budget.hpp"
#include "triskin/session/sample_account.hpp"

namespace triskin::device {

/// Account of one module.
struct ModuleCounts {
  int module = 0;  ///< It is an id of the design.
  int patch = 0;
  SampleCounts counts;
  bool slow = false;  ///< Its controller took fewer than 0.9 of the samples that the rate says.
  int cover = 0;      ///< It indexes the designs of the stream.
  /// True: samples were due and none with data came.
  [[nodiscard]] bool never_heard() const { return counts.expected > 0 && counts.with_data == 0; }
};

/// Account of a module that the controller of another patch read for a time (docs/adoption.md).
/// Beside it the module has its account in StreamReport::modules, of its own controller.
struct AdoptedCounts {
  int module = -1;  ///< It is an id of the design; −1 means that the design has no module there.
  int patch = 0;    ///< The controller of this patch read it.
  SampleCounts counts;
  bool now = false;  ///< Its samples still arrive.
  int cover = 0;     ///< It indexes the designs of the stream.
};

/// What is known of a controller's clock.
struct ClockState {
  int cover = 0;  ///< It indexes the designs of the stream.
  int patch = 0;
  std::uint8_t node = 0;
  double drift_ppm = 0.0;  ///< The clock of the link runs faster by this.
  /// It bounds the time of its latest sample; LinkTime::kUnbounded means that nothing does.
  std::uint32_t error_us = 0;
  int restarts = 0;  ///< Its clock began anew, or contradicted what was known, so often.
};

/// What a reader of the stream got of what was due.
struct StreamReport {
  std::vector<ModuleCounts> modules;   ///< They are sorted by patch, then by row of the table.
  std::vector<AdoptedCounts> adopted;  ///< They are sorted by patch, then in the order in which they were adopted.
  SampleCounts total;
  std::uint64_t lost_bus = 0;      ///< This part of total.on_the_way was lost between the controller and this computer.
  std::uint64_t lost_host = 0;     ///< This computer threw the rest away, or let its lease lapse.
  std::vector<int> never_heard;    ///< These modules sent no sample that has data.
  std::vector<int> slow;           ///< These modules were sampled less often than the rate says.
  std::vector<int> starved;        ///< These patches lost over 1 % of their samples because the bus had no room.
  std::vector<int> silent;         ///< The controllers of these patches were away.
  std::vector<ClockState> clocks;  ///< They are sorted by node address.
  int lapses = 0;                  ///< This computer renewed its lease too late so often.
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
