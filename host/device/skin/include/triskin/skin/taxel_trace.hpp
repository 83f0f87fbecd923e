// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <deque>
#include <string>
#include <vector>

#include "triskin/design/module_number.hpp"
#include "triskin/skin/live_monitor.hpp"

namespace triskin::skin {

/// Plots the pressure of one taxel over the last seconds as a row of blocks, for the strongest taxel or a held one.
class TaxelTrace {
 public:
  /// Adds the present values as one step, which fills one column of the plot.
  void step(const LiveMonitor& monitor);
  /// Toggles between holding the taxel on display and following the strongest one.
  void toggle_hold() { is_held_ = !is_held_ && module_ >= 0; }
  /// Returns two lines of at most `columns` characters: the taxel with its largest count, and its plot with the newest
  /// value at the right. `step_s` is the time of a step. The lines are empty until a taxel has been pressed.
  [[nodiscard]] std::vector<std::string> lines(std::size_t columns, double step_s) const;

 private:
  static constexpr std::size_t kMaxSteps = 200;
  layout::ModuleId module_ = layout::ModuleId::none();
  design::ModuleNumber number_;
  layout::TaxelIndex taxel_ = layout::TaxelIndex::none();
  bool is_held_ = false;
  std::deque<double> counts_;
};

}  // namespace triskin::skin
