// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <deque>
#include <string>
#include <vector>

#include "triskin/skin/live_monitor.hpp"

namespace triskin::device {

/// The pressure of one taxel over the last seconds, as a row of blocks. It follows the strongest taxel, or holds one.
class TaxelTrace {
 public:
  /// Takes the present values; a step is one column of the plot.
  void step(const LiveMonitor& monitor);
  /// Holds the taxel that it shows, or follows the strongest again.
  void toggle_hold() { is_held_ = !is_held_ && module_ >= 0; }
  /// Two lines of at most `columns` characters: which taxel, up to how many counts; and its plot, the newest value at
  /// the right. Empty until a taxel was pressed. `step_s`: time of a step.
  [[nodiscard]] std::vector<std::string> lines(std::size_t columns, double step_s) const;

 private:
  static constexpr std::size_t kMaxSteps = 200;
  int module_ = -1, taxel_ = -1;
  bool is_held_ = false;
  std::deque<double> counts_;
};

}  // namespace triskin::device
