// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "triskin/base/names.hpp"
#include "triskin/base/progress.hpp"
#include "triskin/design/design.hpp"
#include "triskin/link/link.hpp"

namespace triskin::device {

enum class StepOutcome { kPassed, kFailed, kSkipped };
inline constexpr NameTable kStepOutcomeNames{std::array<std::pair<StepOutcome, std::string_view>, 3>{{
    {StepOutcome::kPassed, "passed"},
    {StepOutcome::kFailed, "failed"},
    {StepOutcome::kSkipped, "skipped"},
}}};

/// docs/bring_up.md explains the twelve steps.
struct BringUpStep {
  int number = 0;         ///< Valid values are 1 to 12.
  std::string_view does;  ///< The text tells the person what to do.
  std::string_view measures;
  std::string_view expects;
  std::string_view otherwise;  ///< The text says what a deviation means.
};
/// Returns the steps in order.
[[nodiscard]] const std::array<BringUpStep, 12>& bring_up_steps();

struct StepReport {
  int number = 0;
  StepOutcome outcome = StepOutcome::kSkipped;
  std::string found;  ///< The text has what the program or the person saw, or why the step was skipped.
};

/// A person answers about a step that cannot be observed over the link.
struct StepAnswer {
  StepOutcome outcome = StepOutcome::kSkipped;
  std::string found;
};

struct BringUpOptions {
  /// Asks a person about a step; if it is empty, such steps are skipped.
  std::function<StepAnswer(const BringUpStep&)> ask;
  /// Opens the link when step 7 or 8 is reached. If it throws Error, the step fails, and so do those that need the
  /// link.
  std::function<std::unique_ptr<Link>()> open;
  double stream_s = 2.0;  ///< Step 12 watches the samples for this long (> 0).
  ProgressSink progress;
};

/// Runs the steps in order: it asks the person for measurements, performs the steps over the link itself, and writes
/// the tables of `design` into controllers that lack them. A failed step does not end the others, but steps that need a
/// link are skipped when there is none. Returns a report for each step. Throws Cancelled.
[[nodiscard]] std::vector<StepReport> bring_up(const design::Design& design, const BringUpOptions& options);

/// Formats the reports as Markdown: a table of the steps, then the possible causes of each failure.
[[nodiscard]] std::string to_markdown(const std::vector<StepReport>& reports, std::string_view link_name);

}  // namespace triskin::device
