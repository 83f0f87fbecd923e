// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "triskin/base/names.hpp"
#include "triskin/base/progress.hpp"
#include "triskin/design/design.hpp"
#include "triskin/link/link.hpp"

namespace triskin::deploy {

enum class StepOutcome { kPassed, kFailed, kSkipped };
inline constexpr NameTable kStepOutcomeNames{std::array<std::pair<StepOutcome, std::string_view>, 3>{{
    {StepOutcome::kPassed, "passed"},
    {StepOutcome::kFailed, "failed"},
    {StepOutcome::kSkipped, "skipped"},
}}};

/// A board that firmware/board has images for: what the steps must say of it.
struct BringUpBoard {
  std::string_view name;  ///< The folder of the board.
  std::string_view chip;
  std::string_view chip_id;  ///< The device id of the chip, as a debugger shows it.
  std::string_view part;     ///< The chip with its package, as probe-rs names it.
  std::string_view build;    ///< The folder in build/ that docs/program_board.md builds the image in.
  bool two_banks = true, measures_crystal = true, can_fd = true, usb = true;
  std::string_view boot_pin = "PB8 (CAN RX)";
  bool st_flash_writes_options = true;  ///< st-flash 1.8 does not know those of every chip.
};
/// Returns the boards that have images; the first one is that of docs/program_board.md.
[[nodiscard]] std::span<const BringUpBoard> bring_up_boards();
/// Throws InputError with the known names.
[[nodiscard]] const BringUpBoard& bring_up_board(std::string_view name);

struct ProgrammerLine {
  std::string_view programmer;
  /// Run in the folder of the sources; it erases the chip, writes the factory file and, where the programmer can, the
  /// option bytes, and starts the board.
  std::string command;
};
/// Returns a line for each programmer that docs/program_board.md knows.
[[nodiscard]] std::vector<ProgrammerLine> programmer_lines(const BringUpBoard& board);

/// docs/bring_up.md explains the twelve steps.
struct BringUpStep {
  int number = 0;    ///< Valid values are 1 to 12.
  std::string does;  ///< The text tells the person what to do.
  std::string measures;
  std::string expects;
  std::string otherwise;                   ///< The text says what a deviation means.
  std::vector<ProgrammerLine> commands{};  ///< The person runs one of them; empty in most steps.
};
/// Returns the steps in order, as they read for this board.
[[nodiscard]] std::array<BringUpStep, 12> bring_up_steps(const BringUpBoard& board = bring_up_boards().front());

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
  const BringUpBoard* board = &bring_up_boards().front();  ///< The pointer may not be null.
  /// Asks a person about a step; if it is empty, such steps are skipped.
  std::function<StepAnswer(const BringUpStep&)> ask;
  /// Opens the link when step 7 or 8 is reached. If it throws Error, the step fails, and so do those that need the
  /// link.
  std::function<std::unique_ptr<link::Link>()> open;
  double stream_s = 2.0;  ///< Step 12 watches the samples for this long (> 0).
  ProgressSink progress;
};

/// Runs the steps in order: it asks the person for measurements, performs the steps over the link itself, and writes
/// the tables of `design` into controllers that lack them. A failed step does not end the others, but steps that need a
/// link are skipped when there is none. Returns a report for each step. Throws Cancelled.
[[nodiscard]] std::vector<StepReport> bring_up(const design::Design& design, const BringUpOptions& options);

/// Formats the reports as Markdown: a table of the steps, then the possible causes of each failure.
[[nodiscard]] std::string to_markdown(const std::vector<StepReport>& reports, std::string_view link_name,
                                      const BringUpBoard& board = bring_up_boards().front());

}  // namespace triskin::deploy
