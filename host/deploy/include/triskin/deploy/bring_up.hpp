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

/// One of the twelve steps of docs/bring_up.md.
struct BringUpStep {
  int number = 0;         ///< It ranges from 1 to 12.
  std::string_view does;  ///< It says what to do.
  std::string_view measures;
  std::string_view expects;
  std::string_view otherwise;  ///< It says what a deviation means.
};
/// The steps, in order.
[[nodiscard]] const std::array<BringUpStep, 12>& bring_up_steps();

/// Result of a step.
struct StepReport {
  int number = 0;
  StepOutcome outcome = StepOutcome::kSkipped;
  std::string found;  ///< It is what the program or the person saw, or why the step was skipped.
};

/// A person's answer about a step that no link can observe.
struct StepAnswer {
  StepOutcome outcome = StepOutcome::kSkipped;
  std::string found;
};

struct BringUpOptions {
  /// Asks a person about a step; empty: such steps are skipped.
  std::function<StepAnswer(const BringUpStep&)> ask;
  /// Opens the link, when step 7 or 8 is reached. Throws Error: the step fails, and so do those that need it.
  std::function<std::unique_ptr<Link>()> open;
  double stream_s = 2.0;  ///< The samples of step 12 are watched for so long (> 0).
  ProgressSink progress;
};

/// Leads through the steps in order: asks about what has to be measured, does by itself what goes over the link, writes
/// the tables of `design` into controllers that lack them. A step that fails does not end the others, except that all
/// that need a link are skipped when there is none. Result: a report for each step. Throws Cancelled.
[[nodiscard]] std::vector<StepReport> bring_up(const design::Design& design, const BringUpOptions& options);

/// The report as Markdown: a table of the steps, then for each that failed what it may mean.
[[nodiscard]] std::string to_markdown(const std::vector<StepReport>& reports, std::string_view link_name);

}  // namespace triskin::device
