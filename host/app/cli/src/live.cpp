// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <optional>

#include "calibration_options.hpp"
#include "live_display.hpp"
#include "live_icub.hpp"
#include "live_robot.hpp"
#include "offset_lines.hpp"
#include "site_options.hpp"
#include "stream_options.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/base/pace.hpp"
#include "triskin/layout/module.hpp"

namespace triskin::cli::live_command {
namespace {

constexpr int kWalk = -2, kNobody = -1;

struct Options {
  SiteOptions site;
  std::string protocol = "triskin";
  session::StreamOptions stream;
  CalibrationOptions calibration;
  double seconds = 0.0;
  int press = kWalk;  // The value is the number of a module, kNobody or kWalk.
  int taxel = -1;
  bool tare = false;
};

constexpr std::uint64_t kLine_us = 200'000;
constexpr std::uint64_t kRest_us = 150'000;
constexpr std::uint64_t kFingerMoves_us = 2'000'000;

// Without a scene, nobody would touch the skin in our own simulation, so the virtual finger presses one taxel after
// another. A simulation served by another process has its own contacts, so there the finger presses only on request.
class Demonstrator {
 public:
  Demonstrator(skin::LiveCover& cover, const Options& options)
      : actuator_(options.press >= 0 || (link::is_in_process(options.site.link.link) && options.site.link.scene.empty())
                      ? cover.actuator()
                      : nullptr),
        options_(options),
        modules_(static_cast<int>(cover.design().layout.modules.size())),
        pressed_(options.press < 0 ? layout::ModuleId::none()
                                   : design::require_module(cover.design(), {options.press})) {}
  void step(std::uint64_t elapsed_us) {
    if (actuator_ == nullptr || modules_ == 0 || options_.press == kNobody || elapsed_us < kRest_us) return;
    const int turn = static_cast<int>(elapsed_us / kFingerMoves_us);
    if (turn == turn_ || (turn_ >= 0 && options_.press >= 0)) return;
    turn_ = turn;
    if (options_.press < 0)
      actuator_->press({layout::ModuleId{turn % modules_},
                        layout::TaxelIndex{kTaxelsInTurn[static_cast<std::size_t>(turn) % kTaxelsInTurn.size()]}});
    else if (options_.taxel < 0)
      actuator_->press(pressed_);
    else
      actuator_->press({pressed_, layout::TaxelIndex{options_.taxel}});
  }

 private:
  static constexpr std::array<int, layout::kPressureTaxelsPerModule> kTaxelsInTurn{3, 9, 1, 5, 0, 7, 2, 4, 8, 11};
  static_assert(std::ranges::all_of(kTaxelsInTurn,
                                    [](int t) { return layout::measures_pressure(static_cast<std::size_t>(t)); }));
  link::TouchActuator* actuator_;
  const Options& options_;
  int modules_;
  layout::ModuleId pressed_;
  int turn_ = -1;
};

int run_icub(const Options& options, Output& output) {
  std::optional<design::Design> design;  // Only the simulation needs a design.
  if (!options.site.file.empty()) design = design::read_intact_design(options.site.file);
  return live_icub(options.site.link, design ? &*design : nullptr, options.seconds, output);
}

// One object handles one run of the command: it shows received data and handles keys.
class Show {
 public:
  Show(const Options& options, skin::LiveBus& bus)
      : options_(options), bus_(bus), cover_(bus.covers().front()), demonstrator_(cover_, options) {}

  int run(Output& output) {
    start_us_ = bus_.now_us();
    if (options_.tare) tare();
    {
      const auto display = make_display(cover_.design(), output);
      receive(*display);
    }
    output.result = to_json(cover_.monitor(), state());
    if (!last_pressed_.is_null()) output.result["pressed"] = last_pressed_;
    if (!note_.empty()) output.say(note_);
    bus_.finish();
    return conclude(bus_.report(), output);
  }

 private:
  [[nodiscard]] std::uint64_t elapsed_us() const { return bus_.now_us() - start_us_; }
  [[nodiscard]] LiveState state() const {
    const session::StreamReport report = bus_.report();
    std::uint32_t error_us = 0;
    for (const session::ClockState& c : report.clocks) error_us = std::max(error_us, c.error_us);
    LiveState s{static_cast<double>(elapsed_us()) * 1e-6, bus_.totals().frames, report.total.lost(), note_};
    if (error_us != session::LinkTime::kUnbounded) s.error_us = error_us;
    std::ranges::copy_if(report.adopted, std::back_inserter(s.adopted), &session::AdoptedCounts::now);
    return s;
  }

  void receive(LiveDisplay& display) {
    skin::LiveRun run;
    if (options_.seconds > 0.0) run.until_us = start_us_ + static_cast<std::uint64_t>(options_.seconds * 1e6);
    run.slice_us = kLine_us;
    // An endless simulation without a pace would take a whole core and outrun its viewer.
    std::optional<Pace> pace;
    if (options_.seconds == 0.0) pace.emplace(bus_.now_us());
    std::uint64_t before_us = 0;
    run.before_slice = [&] {
      demonstrator_.step(elapsed_us());
      before_us = elapsed_us();
    };
    run.after_slice = [&] {
      cover_.monitor().close_period(static_cast<double>(elapsed_us() - before_us + 1) * 1e-6);
      if (pace) pace->hold(bus_.now_us());
      return show(display);
    };
    bus_.run(run);
  }

  // Returns false if the person has ended it.
  bool show(LiveDisplay& display) {
    const auto wish = display.show(cover_.monitor(), state());
    nlohmann::json now = to_json(cover_.monitor(), state())["pressed"];
    if (!now.empty()) last_pressed_ = std::move(now);
    if (wish == LiveDisplay::Wish::kTare) tare();
    return wish != LiveDisplay::Wish::kEnd;
  }

  // Uses the present values as rest values, and stores them for the next start.
  void tare() {
    bus_.tare();
    if (interrupt_request()) return;
    note_ = fmt::format("rest values were taken and are kept in {}", cover_.keep_rest().string());
  }

  const Options& options_;
  skin::LiveBus& bus_;
  skin::LiveCover& cover_;
  Demonstrator demonstrator_;
  std::uint64_t start_us_ = 0;
  std::string note_;
  nlohmann::json last_pressed_;
};

// Shows one cover with its picture.
int show_cover(const Options& options, skin::LiveBus& bus, Output& output) {
  skin::LiveCover& cover = bus.covers().front();
  const design::Design& design = cover.design();
  std::vector<std::string> lines;
  nlohmann::json offsets = read_offset_lines(bus.bus(), design, lines);
  for (const std::string& line : lines) output.say(line);
  bus.find_controllers(options.tare ? skin::RestSource::kNone : skin::RestSource::kKept);
  calibrate_cover(options.calibration, bus, cover, output);
  bus.start(speaking(options.stream), {});
  const int status = Show(options, bus).run(output);
  output.result["offsets"] = std::move(offsets);
  output.result["calibration"] = calibration_keys(cover.calibration());
  return status;
}

int run(const Options& options, Output& output) {
  output.expect_interrupt();
  if (options.protocol == "icub") return run_icub(options, output);
  if (options.site.file.empty())
    throw InputError("live: give the design file or robot file; only --protocol icub works without");
  skin::LiveSkin skin = open_skin(options.site, output);
  if (skin.buses().size() == 1 && skin.buses().front()->covers().size() == 1)
    return show_cover(options, *skin.buses().front(), output);
  if (options.press >= 0 || options.tare)
    throw InputError("live: --press and --tare are for one cover of a robot: say which with --cover");
  return live_robot(skin, options.stream, options.calibration, options.seconds, output);
}

const Registration kLive{{
    "live",
    "taxels under pressure: a picture on a terminal, else lines; --json gives an object a line",
    "triskin live forearm.json --link sim --seconds 2",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      add_site_options(app, options->site);
      app.get_option("DESIGN")->required(false)->description(
          "design file, or robot file; may be left out with --protocol icub");
      app.add_option("--protocol", options->protocol,
                     "triskin: full stream; icub: what MTB4 skin boards send, 8 bits a taxel")
          ->check(CLI::IsMember({"triskin", "icub"}));
      add_stream_options(app, options->stream);
      add_calibration_options(app, options->calibration);
      app.add_option("--seconds", options->seconds, "of the link's time; default: until Ctrl-C")
          ->check(CLI::Range(0.0, 1e7));
      app.add_option("--press", options->press,
                     "simulated link: the virtual finger presses this module (-1: none; default: it walks, unless a "
                     "scene presses)")
          ->check(CLI::Range(kNobody, 1'000'000));
      app.add_option("--taxel", options->taxel, "with --press: one taxel of the module, with the finger tip")
          ->check(CLI::Range(0, 11));
      app.add_flag("--tare", options->tare, "first take new rest values and keep them (nobody may touch the skin)");
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kData,
}};

}  // namespace
}  // namespace triskin::cli::live_command
