// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>

#include "command.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/recording/recording.hpp"

namespace triskin::cli::recover_command {
namespace {

struct Options {
  std::string file, output;
};

nlohmann::json losses_json(const std::vector<recording::Loss>& losses) {
  nlohmann::json list = nlohmann::json::array();
  for (const recording::Loss& loss : losses) {
    list.push_back({{"offset", loss.offset},
                    {"bytes", loss.bytes},
                    {"what", loss.what},
                    {"mended", loss.is_mended},
                    {"from_s", loss.from_s},
                    {"to_s", loss.to_s < 0.0 ? nlohmann::json() : nlohmann::json(loss.to_s)}});
  }
  return list;
}

void say_loss(const recording::Loss& loss, Output& output) {
  if (loss.bytes == 0) return output.say(fmt::format("  lost: {}", loss.what));
  const std::string times = loss.to_s < 0.0 ? fmt::format("behind {:.2f} s", loss.from_s)
                                            : fmt::format("between {:.2f} s and {:.2f} s", loss.from_s, loss.to_s);
  const char* fate = loss.is_mended ? "made again" : "lost";
  output.say(
      fmt::format("  {}: {}, bytes {} … {}, {}", fate, loss.what, loss.offset, loss.offset + loss.bytes - 1, times));
}

int run(const Options& options, Output& output) {
  const recording::Recovery r = recording::recover(options.file, options.output);
  const recording::Summary s = recording::read_recording(options.output.empty() ? options.file : options.output, {});
  const double seconds = static_cast<double>(s.last_us - s.first_us) * 1e-6;
  output.result = {{"samples", s.samples},           {"seconds", seconds},
                   {"messages", r.messages},         {"was_complete", r.was_complete},
                   {"kept_bytes", r.kept_bytes},     {"dropped_bytes", r.was_complete ? 0 : r.dropped_bytes},
                   {"losses", losses_json(r.losses)}};
  // Of the old file: a new one lacks channels whose schema is not there.
  for (const std::string& why : recording::read_origin(options.file).not_understood)
    output.say(fmt::format("{}: {}", options.file, why));
  if (r.was_complete) {
    output.say(fmt::format("{}: is whole, {} in {:.2f} s", options.file, counted(s.samples, "module sample"), seconds));
    return 0;
  }
  output.say(fmt::format("{}: {}; {} in {:.2f} s are kept, {} {} dropped", options.file, r.problem,
                         counted(s.samples, "module sample"), seconds, counted(r.dropped_bytes, "byte"),
                         agreeing(r.dropped_bytes, "is", "are")));
  for (const recording::Loss& loss : r.losses) say_loss(loss, output);
  return 0;
}

const Registration kRecover{{
    "recover",
    "repair a recording that was cut or damaged: by a killed process, a full disk, a bad copy",
    "triskin recover touch.mcap",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("FILE", options->file, "recording (.mcap)")->required();
      app.add_option("-o,--output", options->output, "new file (default: FILE itself, if it was only cut short)");
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kData,
}};

}  // namespace
}  // namespace triskin::cli::recover_command
