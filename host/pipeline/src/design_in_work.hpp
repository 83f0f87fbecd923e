// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "triskin/base/progress.hpp"
#include "triskin/design/design.hpp"
#include "triskin/pipeline/make_design.hpp"
#include "triskin/pipeline/time_budget.hpp"

namespace triskin::pipeline {

/// What the steps of make_design() share.
struct DesignInWork {
  std::filesystem::path mesh;
  DesignOptions options;
  ProgressSink progress;
  TimeBudget budget;
  design::Design design;
  DesignNotes notes;

  /// True from `end_s` of the budget on. Empty with a fixed number of iterations: the result must not depend on the
  /// time then.
  [[nodiscard]] std::function<bool()> give_up_at(double end_s) const {
    if (options.iterations > 0) return {};
    return budget.is_over(end_s);
  }
};

}  // namespace triskin::pipeline
