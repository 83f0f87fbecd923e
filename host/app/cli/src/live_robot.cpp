// SPDX-License-Identifier: GPL-3.0-or-later
#include "live_robot.hpp"

#include <fmt/format.h>

#include <mutex>
#include <optional>
#include <vector>

#include "live_display.hpp"
#include "site_options.hpp"
#include "stream_options.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/pace.hpp"

namespace triskin::cli {
namespace {

constexpr std::uint64_t kRobotLine_us = 200'000;

// Shows the covers of one bus while their samples arrive.
class BusShow {
 public:
  BusShow(skin::LiveBus& bus, const CalibrationOptions& calibration, const Output& output) : bus_(bus) {
    bus.find_controllers();
    for (skin::LiveCover& cover : bus.covers()) calibrate_cover(calibration, bus, cover, output);
    off_rest_.resize(bus.covers().size());
  }

  // `mutex` protects `output`.
  void run(const session::StreamOptions& options, double seconds, Output& output, std::mutex& mutex) {
    bus_.start(options, {});
    const std::uint64_t start_us = bus_.now_us();
    skin::LiveRun run;
    if (seconds > 0.0) run.until_us = start_us + static_cast<std::uint64_t>(seconds * 1e6);
    run.slice_us = kRobotLine_us;
    std::optional<Pace> pace;
    if (seconds == 0.0) pace.emplace(start_us);
    run.after_slice = [&] {
      if (pace) pace->hold(bus_.now_us());
      const std::lock_guard lock(mutex);
      show(static_cast<double>(bus_.now_us() - start_us) * 1e-6, output);
      return true;
    };
    bus_.run(run);
    bus_.finish();
  }

  // Prints the result of each cover, and adds its counts to `sum`.
  [[nodiscard]] bool print_report(nlohmann::json& rows, session::SampleCounts& sum, Output& output) const {
    bool complete = true;
    for (std::size_t c = 0; c < bus_.covers().size(); ++c) {
      const robot::CoverConfig& cover = bus_.covers()[c].config();
      const session::StreamReport report = bus_.report(c);
      nlohmann::json row = keys_of(bus_.config(), cover);
      add_stream_keys(report, row);
      row["off_rest"] = to_json(bus_.covers()[c].monitor().off_rest());
      rows.push_back(std::move(row));
      sum += report.total;
      complete = complete && report.complete();
      for (const std::string& line : sentences(report)) output.say(prefix_of(cover) + line);
    }
    return complete;
  }

 private:
  void show(double time_s, Output& output) {
    nlohmann::json object{{"time_s", time_s},
                          {"bus", bus_.config().name},
                          {"frames", bus_.totals().frames},
                          {"lost", bus_.totals().lost}};
    object["pressed"] = nlohmann::json::array();
    object["off_rest"] = nlohmann::json::object();
    for (const skin::LiveCover& cover : bus_.covers()) {
      nlohmann::json of_cover = to_json(cover.monitor(), {});
      for (nlohmann::json& taxel : of_cover["pressed"]) {
        taxel["cover"] = cover.config().name;
        object["pressed"].push_back(std::move(taxel));
      }
      object["off_rest"][cover.config().name] = std::move(of_cover["off_rest"]);
    }
    output.each(object);
    if (!output.json()) say(time_s, output);
  }

  void say(double time_s, Output& output) {
    const auto line = [&](const std::string& text) { output.say(fmt::format("{:7.2f} s  {}", time_s, text)); };
    bool is_pressed = false;
    for (std::size_t c = 0; c < bus_.covers().size(); ++c) {
      const skin::LiveCover& cover = bus_.covers()[c];
      if (const std::string remark = off_rest_[c].due(cover.monitor(), time_s); !remark.empty())
        line(fmt::format("{}: {}", cover.config().name, remark));
      const auto pressed = cover.touches().pressed();
      if (pressed.empty()) continue;
      is_pressed = true;
      line(fmt::format("{}: {}{}", cover.config().name, place_text(cover.monitor(), pressed.front()),
                       more_taxels(pressed.size() - 1)));
    }
    if (!is_pressed && time_s < spoke_s_ + OffRestNotice::kHeartbeat_s) return;
    spoke_s_ = time_s;
    if (!is_pressed)
      line(fmt::format("{}: nothing is pressed; {}, {} lost", bus_.config().name,
                       counted(bus_.totals().frames, "sample"), bus_.totals().lost));
  }

  skin::LiveBus& bus_;
  std::vector<OffRestNotice> off_rest_;  // There is one for each cover.
  double spoke_s_ = 0.0;
};

}  // namespace

int live_robot(skin::LiveSkin& skin, const session::StreamOptions& options, const CalibrationOptions& calibration,
               double seconds, Output& output) {
  std::vector<BusShow> shows;
  for (const auto& bus : skin.buses()) shows.emplace_back(*bus, calibration, output);
  std::mutex mutex;
  skin.on_each_bus([&](skin::LiveBus& bus) { shows[bus.index()].run(speaking(options), seconds, output, mutex); });
  session::SampleCounts sum;
  nlohmann::json covers = nlohmann::json::array();
  bool complete = true;
  for (const BusShow& show : shows) complete = show.print_report(covers, sum, output) && complete;
  output.result = {{"samples", sum.received}, {"expected", sum.expected}, {"lost", sum.lost()}, {"covers", covers}};
  output.say(fmt::format("{} of {} of {}, {} lost", sum.received, counted(sum.expected, "sample"),
                         counted(covers.size(), "cover"), sum.lost()));
  return complete ? 0 : 1;
}

}  // namespace triskin::cli
