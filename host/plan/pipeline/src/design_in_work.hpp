// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "later_steps.hpp"
#include "triskin/base/progress.hpp"
#include "triskin/design/design.hpp"
#include "triskin/pipeline/make_design.hpp"
#include "triskin/pipeline/time_budget.hpp"

namespace triskin::pipeline {

/// The steps of make_design() read and change this state in turn.
struct DesignInWork {
  std::filesystem::path mesh;
  DesignOptions options;
  ProgressSink progress;
  TimeBudget budget;
  design::Design design;
  DesignNotes notes;

  /// Returns the deadline of a step that should end at `end_s` of the budget.
  [[nodiscard]] std::function<bool()> deadline(double end_s) const {
    return give_up_at(budget, end_s, options.iterations);
  }
};

}  // namespace triskin::pipeline
