// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <optional>

#include "live_display.hpp"
#include "live_icub.hpp"
#include "live_robot.hpp"
#include "offset_lines.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/cli/calibration_options.hpp"
#include "triskin/cli/site_options.hpp"
#include "triskin/cli/stream_options.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/link/cover_link.hpp"
#include "triskin/skin/live_monitor.hpp"
#include "triskin/skin/rest_store.hpp"

namespace triskin::cli::live_command {
namespace {

constexpr int kWalk = -2, kNobody = -1;

struct Options {
  SiteOptions site;
  std::string protocol = "triskin";
  device::StreamOptions stream;
  CalibrationOptions calibration;
  double seconds = 0.0;
  int press = kWalk;  // module, kNobody, or kWalk
  int taxel = -1;
  bool tare = false;
};

constexpr std::uint64_t kLine_us = 200'000;
constexpr std::uint64_t kTareMost_us = 2'000'000;
constexpr std::uint64_t kRest_us = 150'000;
constexpr std::uint64_t kFingerMoves_us = 2'000'000;

// In a simulation of our own without a scene nobody would touch the skin: the virtual finger tips on one taxel after
// another. A simulation that somebody else serves has contacts of its own, so there it presses only what it is told to.
class Demonstrator {
 public:
  Demonstrator(device::Link& link, const Options& options, int modules)
      : finger_(options.press >= 0 || (device::is_in_process(options.site.link.link) && options.site.link.scene.empty())
                    ? link.finger()
                    : nullptr),
        options_(options),
        modules_(modules) {}
  void step(std::uint64_t elapsed_us) {
    if (finger_ == nullptr || modules_ == 0 || options_.press == kNobody || elapsed_us < kRest_us) return;
    const int turn = static_cast<int>(elapsed_us / kFingerMoves_us);
    if (turn == turn_ || (turn_ >= 0 && options_.press >= 0)) return;
    turn_ = turn;
    const int module = options_.press >= 0 ? options_.press : turn % modules_;
    finger_->press(module, options_.press >= 0 ? options_.taxel
                                               : kTaxelsInTurn[static_cast<std::size_t>(turn) % kTaxelsInTurn.size()]);
  }

 private:
  static constexpr std::array<int, layout::kPressureTaxelsPerModule> kTaxelsInTurn{3, 9, 1, 5, 0, 7, 2, 4, 8, 11};
  static_assert(std::ranges::all_of(kTaxelsInTurn,
                                    [](int t) { return layout::measures_pressure(static_cast<std::size_t>(t)); }));
  device::Finger* finger_;
  const Options& options_;
  int modules_;
  int turn_ = -1;
};

int run_icub(const Options& options, Output& output) {
  std::optional<design::Design> design;  // Only the simulation needs a design.
  if (!options.site.file.empty()) design = design::read_intact_design(options.site.file);
  return live_icub(options.site.link, design ? &*design : nullptr, options.seconds, output);
}

// One run of the command: receives, shows, and does what the keys ask for.
class Show {
 public:
  Show(const Options& options, const design::Design& design, device::Link& link, device::Bus& bus,
       device::Stream& stream, device::LiveMonitor& monitor, const device::RestStore& store)
      : options_(options),
        design_(design),
        bus_(bus),
        stream_(stream),
        monitor_(monitor),
        store_(store),
        demonstrator_(link, options, static_cast<int>(design.layout.modules.size())) {}

  int run(Output& output) {
    start_us_ = bus_.now_us();
    if (options_.tare) tare();
    {
      const auto display = make_display(design_, output);
      receive(*display);
    }
    output.result = to_json(monitor_, state());
    if (!last_pressed_.is_null()) output.result["pressed"] = last_pressed_;
    if (!note_.empty()) output.say(note_);
    stream_.finish();
    return conclude(stream_.report(), output);
  }

 private:
  [[nodiscard]] std::uint64_t elapsed_us() const { return bus_.now_us() - start_us_; }
  [[nodiscard]] LiveState state() const {
    const device::StreamReport report = stream_.report();
    std::uint32_t error_us = 0;
    for (const device::ClockState& c : report.clocks) error_us = std::max(error_us, c.error_us);
    LiveState s{static_cast<double>(elapsed_us()) * 1e-6, stream_.frames(), report.total.lost(), note_};
    if (error_us != device::LinkTime::kUnbounded) s.error_us = error_us;
    std::ranges::copy_if(report.adopted, std::back_inserter(s.adopted), &device::AdoptedCounts::now);
    return s;
  }

  void receive(LiveDisplay& display) {
    const auto end_us = static_cast<std::uint64_t>(options_.seconds * 1e6);
    while ((end_us == 0 || elapsed_us() < end_us) && !interrupt_request()) {
      demonstrator_.step(elapsed_us());
      const std::uint64_t before_us = elapsed_us();
      const std::uint64_t until_us = end_us == 0 ? before_us + kLine_us : std::min(before_us + kLine_us, end_us);
      try {
        stream_.run_until(start_us_ + until_us);
      } catch (const Cancelled&) {
        return;  // Ctrl-C is the usual end
      }
      monitor_.close_period(static_cast<double>(elapsed_us() - before_us + 1) * 1e-6);
      const auto wish = display.show(monitor_, state());
      nlohmann::json now = to_json(monitor_, state())["pressed"];
      if (!now.empty()) last_pressed_ = std::move(now);
      if (wish == LiveDisplay::Wish::kEnd) return;
      if (wish == LiveDisplay::Wish::kTare) tare();
    }
  }

  // Takes the present values for those of a skin that nobody touches, and keeps them for the next time.
  void tare() {
    monitor_.touches().tare();
    const std::uint64_t end_us = bus_.now_us() + kTareMost_us;
    const std::uint64_t frames = stream_.frames();
    try {
      do {
        stream_.run_until(bus_.now_us() + kLine_us);
      } while (!monitor_.touches().tared() && bus_.now_us() < end_us);
    } catch (const Cancelled&) {
      return;
    }
    if (stream_.frames() == frames) throw DeviceError(bus_.name() + ": no sample came, so there is nothing to tare");
    store_.write(monitor_.touches().rest());
    note_ = fmt::format("rest values were taken and are kept in {}", store_.file().string());
  }

  const Options& options_;
  const design::Design& design_;
  device::Bus& bus_;
  device::Stream& stream_;
  device::LiveMonitor& monitor_;
  const device::RestStore& store_;
  Demonstrator demonstrator_;
  std::uint64_t start_us_ = 0;
  std::string note_;
  nlohmann::json last_pressed_;
};

// One cover, with its picture.
int show_cover(const Options& options, const robot::BusConfig& site, const robot::CoverConfig& cover,
               device::Link& bus_link, Output& output) {
  const design::Design& design = cover.design;
  const int modules = static_cast<int>(design.layout.modules.size());
  if (options.press >= modules)
    throw InputError(fmt::format("--press {}: the design has modules 0 … {}", options.press, modules - 1));
  device::CoverLink link(bus_link, cover.first_module);
  device::Bus bus(link);
  std::vector<std::string> lines;
  nlohmann::json offsets = read_offset_lines(bus, design, lines);
  for (const std::string& line : lines) output.say(line);
  const std::vector<wire::NodeClaim> boards = bus.discover();
  const device::RestStore store(design, boards);
  device::LiveMonitor monitor(design, options.tare ? design::RestValues{} : store.read(),
                              calibration_for(options.calibration, bus, cover, boards, output));
  const std::array streamed{&design};
  device::Stream stream(
      bus, design, [&](const device::ModuleSample& f) { monitor.add(f); },
      robot::stream_options(site, streamed, speaking(options.stream)));
  const int status = Show(options, design, link, bus, stream, monitor, store).run(output);
  output.result["offsets"] = std::move(offsets);
  output.result["calibration"] = calibration_keys(monitor.calibration());
  return status;
}

int run(const Options& options, Output& output) {
  output.expect_interrupt();
  if (options.protocol == "icub") return run_icub(options, output);
  if (options.site.file.empty())
    throw InputError("live: give the design file or robot file; only --protocol icub works without");
  OpenSite open = open_site(options.site, output);
  const bool one =
      open.site.buses.size() == 1 && std::ranges::count_if(open.site.buses[0].covers, &robot::CoverConfig::chosen) == 1;
  if (one) {
    const auto& covers = open.site.buses[0].covers;
    return show_cover(options, open.site.buses[0], *std::ranges::find_if(covers, &robot::CoverConfig::chosen),
                      *open.links[0], output);
  }
  if (options.press >= 0 || options.tare)
    throw InputError("live: --press and --tare are for one cover of a robot: say which with --cover");
  return live_robot(open, options.stream, options.calibration, options.seconds, output);
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
                     "simulated link: the virtual finger presses this module (-1: none; by default it walks on --link "
                     "sim without a scene)")
          ->check(CLI::Range(kNobody, 1'000'000));
      app.add_option("--taxel", options->taxel, "with --press: one taxel of the module, with the finger tip")
          ->check(CLI::Range(0, 11));
      app.add_flag("--tare", options->tare,
                   "first take the present values as those at rest, and keep them: nobody may touch the skin");
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kData,
}};

}  // namespace
}  // namespace triskin::cli::live_command
