// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/deploy/bring_up.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>

#include "link_options.hpp"
#include "triskin/base/files.hpp"

namespace triskin::cli::bring_up_command {
namespace {

struct Options {
  std::string design, report, board{deploy::bring_up_boards().front().name};
  connect::LinkOptions link;
  bool no_questions = false;
  double seconds = 2.0;
};

// Enter means "as expected"; a text beginning with "!" means "not as expected"; "s" means "skipped"; anything else is a
// measured value.
deploy::StepAnswer ask_person(const deploy::BringUpStep& step) {
  std::cerr << fmt::format("\nStep {}. {}\n", step.number, step.does);
  for (const deploy::ProgrammerLine& line : step.commands)
    std::cerr << fmt::format("  {}: {}\n", line.programmer, line.command);
  std::cerr << fmt::format(
                   "  Measure: {}\n  Should be: {}\n  Otherwise: {}\n  Enter: as it should be; VALUE: measured and "
                   "right; ! VALUE: measured and wrong; s: skip > ",
                   step.measures, step.expects, step.otherwise)
            << std::flush;
  std::string line;
  if (!std::getline(std::cin, line) || line == "s") return {deploy::StepOutcome::kSkipped, "not done"};
  if (line.starts_with('!')) return {deploy::StepOutcome::kFailed, line.substr(std::min<std::size_t>(line.size(), 2))};
  return {deploy::StepOutcome::kPassed, line.empty() ? "as it should be" : line};
}

nlohmann::json report_steps(const std::vector<deploy::StepReport>& reports, const Output& output) {
  nlohmann::json list = nlohmann::json::array();
  for (const deploy::StepReport& r : reports) {
    const auto outcome = deploy::kStepOutcomeNames.name(r.outcome);
    list.push_back({{"step", r.number}, {"outcome", outcome}, {"found", r.found}});
    output.say(fmt::format("step {:2}  {:7}  {}", r.number, outcome, r.found));
  }
  return list;
}

int run(const Options& options, Output& output) {
  const design::Design design = design::read_intact_design(options.design);
  connect::require_link(options.link);
  deploy::BringUpOptions steps;
  steps.board = &deploy::bring_up_board(options.board);
  if (!options.no_questions) steps.ask = ask_person;
  steps.open = [&] { return connect::open_link(options.link, &design); };
  steps.stream_s = options.seconds;
  if (options.no_questions) steps.progress = output.progress();
  const bool simulated = link::is_simulated(options.link.link);
  if (simulated) output.mark_simulated();
  const auto reports = deploy::bring_up(design, steps);
  output.result = {{"steps", report_steps(reports, output)}};
  const std::string link = options.link.link + (simulated ? " (simulated)" : "");
  if (!options.report.empty()) write_output(options.report, deploy::to_markdown(reports, link, *steps.board));
  const bool bad = std::ranges::count(reports, deploy::StepOutcome::kFailed, &deploy::StepReport::outcome) > 0;
  return bad ? 1 : 0;
}

const Registration kBringUp{{
    "bring-up",
    "lead through the twelve steps from a bare board to a streaming patch, and write a report",
    "triskin bring-up forearm.json --link can:can0 -o report.md",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("DESIGN", options->design, "design file")->required();
      add_link_options(app, options->link);
      app.add_option("-o,--output", options->report, "report (Markdown)");
      std::vector<std::string> boards;
      for (const deploy::BringUpBoard& board : deploy::bring_up_boards()) boards.emplace_back(board.name);
      app.add_option("--board", options->board, "board that the steps are for (docs/program_board.md)")
          ->check(CLI::IsMember(boards))
          ->capture_default_str();
      app.add_flag("--no-questions", options->no_questions, "only what the link shows; nobody is asked");
      app.add_option("--seconds", options->seconds, "how long the samples of the last step are watched")
          ->check(CLI::Range(0.2, 3600.0))
          ->capture_default_str();
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kHardware,
}};

}  // namespace
}  // namespace triskin::cli::bring_up_command
