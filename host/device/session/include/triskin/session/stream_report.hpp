// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/session/bus_budget.hpp"
#include "triskin/session/sample_account.hpp"

namespace triskin::session {

struct ModuleCounts {
  layout::ModuleId module;
  layout::PatchIndex patch;
  SampleCounts counts;
  bool slow = false;  ///< True means that the controller took fewer than 0.9 of the samples that the rate demands.
  layout::CoverIndex cover{};
  design::ModuleNumber number{};  ///< what people read
  /// Returns true if samples were due and none with data arrived.
  [[nodiscard]] bool never_heard() const { return counts.expected > 0 && counts.with_data == 0; }
};

/// The controller of another patch read this module for a time (switched_module.md). The module also has an account of
/// its own controller in StreamReport::modules.
struct AdoptedCounts {
  layout::ModuleId module = layout::ModuleId::none();  ///< −1 means that the design has no module there.
  layout::PatchIndex patch;                            ///< The controller of this patch read the module.
  SampleCounts counts;
  bool now = false;  ///< True means that samples still arrive.
  layout::CoverIndex cover{};
  design::ModuleNumber number{};  ///< what people read
};

struct ClockState {
  layout::CoverIndex cover{};
  layout::PatchIndex patch;
  std::uint8_t node = 0;
  double drift_ppm = 0.0;  ///< The clock of the link runs faster than the controller's by this.
  /// The time of the latest sample has at most this error; LinkTime::kUnbounded means that no bound is known.
  std::uint32_t error_us = 0;
  int restarts = 0;  ///< The clock restarted, or contradicted earlier facts, this often.
};

/// A reader of the stream learns what was due, and what arrived.
struct StreamReport {
  std::vector<ModuleCounts> modules;   ///< The list is sorted by patch, then by row of the table.
  std::vector<AdoptedCounts> adopted;  ///< The list is sorted by patch, then in the order of adoption.
  SampleCounts total;
  std::uint64_t lost_bus = 0;  ///< Of total.on_the_way, this part was lost between the controller and this computer.
  /// Of total.on_the_way, this part was lost because this computer discarded it or renewed its lease too late.
  std::uint64_t lost_host = 0;
  std::vector<design::ModuleNumber> never_heard;  ///< These modules sent no sample with data.
  std::vector<design::ModuleNumber> slow;         ///< These modules were sampled less often than the rate demands.
  /// These patches lost over 1 % of their samples because the bus had no room.
  std::vector<layout::PatchIndex> starved;
  std::vector<layout::PatchIndex> silent;  ///< The controllers of these patches did not answer for a time.
  std::vector<ClockState> clocks;          ///< The list is sorted by node address.
  int lapses = 0;                          ///< This computer renewed its lease too late this often.
  BusBudget budget;
  /// Returns true if every sample that was due arrived, with data from every module.
  [[nodiscard]] bool complete() const {
    return total.lost() == 0 && never_heard.empty() && slow.empty() && silent.empty();
  }
};

/// Computes every field that follows from `modules` and `adopted`. `thrown_away` counts frames that this computer
/// discarded.
void sum_up(StreamReport& report, std::uint64_t thrown_away);

/// Returns text for a person: the counts in one sentence, then one for each kind of missing samples, with the remedy.
/// `diagnosis` says where the cause is found when samples of single modules are missing.
[[nodiscard]] std::vector<std::string> sentences(const StreamReport& report,
                                                 std::string_view diagnosis = "run triskin verify");

}  // namespace triskin::session
