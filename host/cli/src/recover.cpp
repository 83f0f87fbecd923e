// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>

#include "triskin/cli/command.hpp"
#include "triskin/recording/recording.hpp"

namespace triskin::cli::recover_command {
namespace {

struct Options {
  std::string file, output;
};

int run(const Options& options, Output& output) {
  const recording::Recovery r = recording::recover(options.file, options.output);
  const recording::Summary s = recording::read_recording(options.output.empty() ? options.file : options.output, {});
  const double seconds = static_cast<double>(s.last_us - s.first_us) * 1e-6;
  output.result = {{"samples", s.samples},       {"seconds", seconds},
                   {"messages", r.messages},     {"was_complete", r.was_complete},
                   {"kept_bytes", r.kept_bytes}, {"dropped_bytes", r.was_complete ? 0 : r.dropped_bytes}};
  if (r.was_complete)
    output.say(fmt::format("{}: is whole, {} module samples in {:.2f} s", options.file, s.samples, seconds));
  else
    output.say(fmt::format("{}: {}; {} module samples in {:.2f} s are kept, {} bytes of an open chunk are dropped",
                           options.file, r.problem, s.samples, seconds, r.dropped_bytes));
  return 0;
}

const Registration kRecover{{
    "recover",
    "make a recording whole that was cut: by a killed process, a full disk, a power failure",
    "triskin recover touch.mcap",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("FILE", options->file, "recording (.mcap)")->required();
      app.add_option("-o,--output", options->output, "new file; default: FILE itself is completed");
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kData,
}};

}  // namespace
}  // namespace triskin::cli::recover_command
