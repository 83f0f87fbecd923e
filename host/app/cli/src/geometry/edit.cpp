// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>

#include "design_edit.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/interrupt.hpp"

namespace triskin::cli::edit_command {
namespace {

struct Options {
  std::string design, output;
  EditOptions edit;
  pipeline::DesignOptions effort;
};

int run(const Options& options, Output& output) {
  if (!options.edit.any())
    throw InputError("edit: say what to change: --take, --keep, --add, --remove, --mirror or --kinds");
  catch_interrupts();
  require_design_output(options.output);
  return edit(options.design, options.output, options.edit, options.effort, output);
}

// Only the search of --keep takes time.
void add_effort(CLI::App& app, pipeline::DesignOptions& effort) {
  CLI::Option* keep = app.get_option("--keep");
  app.add_option("--time-limit-s", effort.time_limit_s, "with --keep: time limit of the search")
      ->check(CLI::Range(0.01, 1e6))
      ->capture_default_str()
      ->needs(keep);
  app.add_option("--threads", effort.threads, "with --keep: threads of the search; the result depends on their number")
      ->check(CLI::Range(1, 256))
      ->capture_default_str()
      ->needs(keep);
  app.add_option("--iterations", effort.iterations, "with --keep: steps of each thread (0: as the time permits)")
      ->check(CLI::Range(0, 1000000000))
      ->capture_default_str()
      ->needs(keep);
}

const Registration kEdit{{
    "edit",
    "change a design: take an alternative, keep, add, remove or mirror modules, give them kinds",
    "triskin edit forearm.json --remove 3,7-9 -o smaller.json",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("DESIGN", options->design, "design file; stays as it is")->required();
      app.add_option("-o,--output", options->output, "design file")->required();
      options->edit.add_to(app);
      add_effort(app, options->effort);
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kDesign,
}};

}  // namespace
}  // namespace triskin::cli::edit_command
