// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>

#include "command.hpp"
#include "recorded_track.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/hardware/robot_scene.hpp"
#include "triskin/scenario/contact_density.hpp"

namespace triskin::cli::touched_command {
namespace {

struct Options {
  std::string input, output;
  double max_weight = 5.0;
  double seconds = 0.0;
};

int run(const Options& options, Output& output) {
  if (!is_recording(options.input) && hardware::is_robot_scene(options.input)) {
    throw InputError(
        fmt::format("{}: is a scene of a robot, but regions are those of one part; give a scene with a \"design\" and "
                    "the contacts of that part, or the recording of its cover",
                    options.input));
  }
  const scenario::ContactDensity density =
      is_recording(options.input) ? scenario::density_of_recording(options.input)
                                  : scenario::density_of_scene(hardware::read_scene(options.input), options.seconds);
  write_output(options.output, scenario::regions_text(density, options.max_weight));
  output.result = {{"files", {options.output}},
                   {"touched_modules", density.touched_modules()},
                   {"modules", density.touched_s.size()},
                   {"seconds", density.duration_s},
                   {"numbers", design::all_numbers(density.design.layout)},
                   {"touched_s", density.touched_s}};
  output.say(fmt::format("{}: {} of {} {} touched in {:.3g} s; give it to triskin design --regions", options.output,
                         density.touched_modules(), counted(density.touched_s.size(), "module"),
                         agreeing(density.touched_modules(), "was", "were"), density.duration_s));
  return 0;
}

const Registration kTouched{{
    "touched",
    "turn the touches of a recording or a scene into weights for design --regions",
    "triskin touched work.mcap -o touched.regions.json && triskin design forearm.obj --regions touched.regions.json -o "
    "forearm.json",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("INPUT", options->input, "recording (.mcap) or scene file (docs/scene.md)")->required();
      app.add_option("-o,--output", options->output, "region file (docs/regions.md)")->required();
      app.add_option("--max-weight", options->max_weight,
                     "value of a module where contacts lasted longest (1 where there were none)")
          ->check(CLI::Range(1.0, 1000.0))
          ->capture_default_str();
      app.add_option("--seconds", options->seconds, "scene: how long to watch (0: until its contacts end)")
          ->check(CLI::Range(0.0, 1e5))
          ->capture_default_str();
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kDesign,
}};

}  // namespace
}  // namespace triskin::cli::touched_command
