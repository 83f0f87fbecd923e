// SPDX-License-Identifier: GPL-3.0-or-later
#include "live_robot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>

#include "live_display.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/cli/stream_options.hpp"
#include "triskin/skin/live_monitor.hpp"
#include "triskin/skin/rest_store.hpp"

namespace triskin::cli {
namespace {

constexpr std::uint64_t kRobotLine_us = 200'000;

// The covers of one bus while their samples come.
class BusShow {
 public:
  BusShow(const robot::BusConfig& site, device::Link& link, device::StreamOptions options,
          const CalibrationOptions& calibration, const Output& output)
      : site_(site), bus_(link), options_(std::move(options)) {
    const auto claims = bus_.discover();
    for (const robot::CoverConfig& cover : site.covers) {
      if (!cover.chosen) continue;
      covers_.push_back(&cover);
      designs_.push_back(&cover.design);
      monitors_.emplace_back(cover.design, device::RestStore(cover.design, claims).read(),
                             calibration_for(calibration, bus_, cover, claims, output));
    }
    options_ = robot::stream_options(site, designs_, std::move(options_));
  }

  // `mutex` guards `output`.
  void run(double seconds, Output& output, std::mutex& mutex) {
    device::Stream stream(
        bus_, designs_, [this](const device::ModuleSample& f) { monitors_[static_cast<std::size_t>(f.cover)].add(f); },
        options_);
    const std::uint64_t start_us = bus_.now_us();
    const auto end_us = seconds > 0.0 ? start_us + static_cast<std::uint64_t>(seconds * 1e6) : UINT64_MAX;
    try {
      while (bus_.now_us() < end_us && !interrupt_request()) {
        stream.run_until(std::min(end_us, bus_.now_us() + kRobotLine_us));
        const std::lock_guard lock(mutex);
        show(static_cast<double>(bus_.now_us() - start_us) * 1e-6, stream, output);
      }
    } catch (const Cancelled&) {
      // Ctrl-C is the usual end
    }
    stream.finish();
    for (std::size_t c = 0; c < covers_.size(); ++c) reports_.push_back(stream.report(static_cast<int>(c)));
  }

  // Prints the result of each cover.
  [[nodiscard]] bool print_report(nlohmann::json& rows, Output& output) const {
    bool complete = true;
    for (std::size_t c = 0; c < covers_.size(); ++c) {
      nlohmann::json row = keys_of(site_, *covers_[c]);
      add_stream_keys(reports_[c], row);
      rows.push_back(std::move(row));
      complete = complete && reports_[c].complete();
      for (const std::string& line : sentences(reports_[c])) output.say(prefix_of(*covers_[c]) + line);
    }
    return complete;
  }
  [[nodiscard]] const std::vector<device::StreamReport>& reports() const { return reports_; }

 private:
  void show(double time_s, const device::Stream& stream, Output& output) {
    nlohmann::json object{
        {"time_s", time_s}, {"bus", site_.name}, {"frames", stream.frames()}, {"lost", stream.lost()}};
    object["pressed"] = nlohmann::json::array();
    for (std::size_t c = 0; c < covers_.size(); ++c) {
      nlohmann::json of_cover = to_json(monitors_[c], {});
      for (nlohmann::json& taxel : of_cover["pressed"]) {
        taxel["cover"] = covers_[c]->name;
        object["pressed"].push_back(std::move(taxel));
      }
      const auto pressed = monitors_[c].touches().pressed();
      if (pressed.empty() || output.json()) continue;
      const auto& first = pressed.front();
      output.say(fmt::format("{:7.2f} s  {}: {} +{} taxels", time_s, covers_[c]->name, place_text(monitors_[c], first),
                             pressed.size() - 1));
    }
    output.each(object);
  }

  const robot::BusConfig& site_;
  device::Bus bus_;
  device::StreamOptions options_;
  std::vector<const robot::CoverConfig*> covers_;
  std::vector<const design::Design*> designs_;
  std::vector<device::LiveMonitor> monitors_;
  std::vector<device::StreamReport> reports_;
};

}  // namespace

int live_robot(OpenSite& open, const device::StreamOptions& options, const CalibrationOptions& calibration,
               double seconds, Output& output) {
  std::vector<std::unique_ptr<BusShow>> shows;
  for (std::size_t b = 0; b < open.site.buses.size(); ++b)
    shows.push_back(
        std::make_unique<BusShow>(open.site.buses[b], *open.links[b], speaking(options), calibration, output));
  std::mutex mutex;
  on_each_bus(open, [&](const robot::BusConfig& bus, device::Link&) {
    shows[static_cast<std::size_t>(&bus - open.site.buses.data())]->run(seconds, output, mutex);
  });
  device::SampleCounts sum;
  nlohmann::json covers = nlohmann::json::array();
  bool complete = true;
  for (const auto& show : shows) {
    complete = show->print_report(covers, output) && complete;
    for (const device::StreamReport& r : show->reports()) sum += r.total;
  }
  output.result = {{"samples", sum.received}, {"expected", sum.expected}, {"lost", sum.lost()}, {"covers", covers}};
  output.say(
      fmt::format("{} of {} samples of {} covers, {} lost", sum.received, sum.expected, covers.size(), sum.lost()));
  return complete ? 0 : 1;
}

}  // namespace triskin::cli
