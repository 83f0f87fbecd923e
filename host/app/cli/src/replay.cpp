// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>

#include "command.hpp"
#include "expose_option.hpp"
#include "live_display.hpp"
#include "recorded_track.hpp"
#include "replay_link.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/base/pace.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/recording/recording.hpp"

namespace triskin::cli::replay_command {
namespace {

struct Options {
  std::string file, listen;
  double speed = 1.0;
  bool loop = false, expose = false;
};

struct Ended {};  // The exception is thrown when a person ends the replay.

// Plays samples into the display of `live` at the pace at which they arrived.
class Player {
 public:
  Player(const Options& options, RecordedSkin& skin, LiveDisplay& display)
      : options_(options),
        design_(skin.design),
        monitor_(skin.design, skin.rest, std::move(skin.calibration)),
        display_(display) {}

  void take(const recording::ModuleSample& s) {
    if (static_cast<std::size_t>(s.module) >= design_.layout.modules.size()) return;
    if (frames_ == 0) start_us_ = period_us_ = s.link_time_us;
    while (s.link_time_us >= period_us_ + kPeriod_us) show(period_us_ + kPeriod_us);
    monitor_.add({s.module, s.link_time_us, s.sample});
    if (s.adopter >= 0)
      adopted_[s.module] = s.adopter;
    else
      adopted_.erase(s.module);
    ++frames_;
    last_us_ = s.link_time_us;
  }
  void show_rest() {
    if (frames_ > 0) show(last_us_);
  }
  [[nodiscard]] LiveState state() const {
    LiveState s{time_s(period_us_), frames_, 0, {}};
    for (const auto& [module, patch] : adopted_) {
      s.adopted.push_back(
          {.module = module, .patch = patch, .counts = {}, .now = true, .number = design::number_of(design_, module)});
    }
    return s;
  }
  /// Returns the time of the replay at which something arrived.
  [[nodiscard]] double time_s(std::uint64_t link_us) const {
    return static_cast<double>(static_cast<std::int64_t>(link_us - start_us_)) * 1e-6;
  }
  [[nodiscard]] const skin::LiveMonitor& monitor() const { return monitor_; }

 private:
  static constexpr std::uint64_t kPeriod_us = 200'000;

  void show(std::uint64_t now_us) {
    wait(now_us - period_us_);
    monitor_.close_period(static_cast<double>(now_us - period_us_ + 1) * 1e-6);
    period_us_ = now_us;
    const auto wish = display_.show(monitor_, state());
    if (wish == LiveDisplay::Wish::kEnd || interrupt_request()) throw Ended{};
    if (wish == LiveDisplay::Wish::kTare) monitor_.touches().tare();
  }
  void wait(std::uint64_t span_us) const {
    if (options_.speed <= 0.0) return;
    constexpr double kMaxPause_us = 1e12;  // The clock counts nanoseconds in 64 bits.
    const std::chrono::duration<double, std::micro> span(
        std::min(kMaxPause_us, static_cast<double>(span_us) / options_.speed));
    using Clock = std::chrono::steady_clock;
    (void)sleep_until(Clock::now() + std::chrono::duration_cast<Clock::duration>(span));
  }

  const Options& options_;
  const design::Design& design_;
  skin::LiveMonitor monitor_;
  LiveDisplay& display_;
  // For each adopted module, the map has the patch whose controller reads it.
  std::map<layout::ModuleId, layout::PatchIndex> adopted_;
  std::uint64_t start_us_ = 0, period_us_ = 0, last_us_ = 0, frames_ = 0;
};

void tell_readers(const design::Design& design, const recording::Summary& summary, const Player& player,
                  Output& output) {
  nlohmann::json rows = nlohmann::json::array();
  for (const recording::ReaderChange& c : summary.reader_changes) {
    const double time_s = player.time_s(c.link_time_us);
    rows.push_back({{"time_s", time_s},
                    {"module", design::number_of(design, c.module)},
                    {"patch", c.reader.patch},
                    {"node", c.reader.node}});
    output.say(fmt::format("from {:.2f} s on module {} is read by {}controller of patch {}", time_s,
                           design::number_of(design, c.module), c.own ? "its own, the " : "the ", c.reader.patch));
  }
  output.result["readers"] = std::move(rows);
}

int run(const Options& options, Output& output) {
  if (!options.listen.empty()) {
    if (options.speed <= 0.0) throw InputError("replay: --listen plays in time; give a --speed above 0");
    return replay_into_link({options.file, options.listen, options.speed, options.loop, options.expose}, output);
  }
  if (options.loop) throw InputError("replay: --loop belongs to --listen");
  catch_interrupts();
  RecordedSkin recorded = recorded_skin(options.file);
  const design::Design& design = recorded.design;
  recording::Summary summary;
  auto display = make_display(design, output);
  Player player(options, recorded, *display);
  try {
    summary = recording::read_recording(options.file, [&](const recording::ModuleSample& s) { player.take(s); });
    player.show_rest();
  } catch (const Ended&) {
    summary.file.complete = true;  // The extent of the file was not examined.
  }
  display.reset();  // Destroying the display restores the terminal.
  output.result = to_json(player.monitor(), player.state());
  output.result["samples"] = player.state().frames;
  output.result["seconds"] = player.state().time_s;
  output.result["complete"] = summary.file.complete;
  tell_readers(design, summary, player, output);
  output.say(fmt::format("{} in {:.2f} s", counted(player.state().frames, "module sample"), player.state().time_s));
  for (const std::string& why : summary.not_understood) output.say(fmt::format("{}: {}", options.file, why));
  if (!summary.file.complete)
    output.say(fmt::format("the recording {}; triskin recover makes it whole", summary.file.problem));
  return player.state().frames == 0 ? 1 : 0;
}

const Registration kReplay{{
    "replay",
    "play a recording as live shows it, or into a link",
    "triskin replay touch.mcap --speed 2",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("FILE", options->file, "recording (.mcap)")->required();
      app.add_option("--speed", options->speed, "speed, relative to the recording (0: as fast as possible)")
          ->check(CLI::Range(0.0, 1000.0))
          ->capture_default_str();
      app.add_option("--listen", options->listen,
                     "serve it to other programs: HOST:PORT (then --link sim:HOST:PORT), can:IFACE or usb; it begins "
                     "with the first client");
      add_expose_option(app, options->expose);
      app.add_flag("--loop", options->loop, "with --listen: repeat until Ctrl-C");
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kData,
}};

}  // namespace
}  // namespace triskin::cli::replay_command
