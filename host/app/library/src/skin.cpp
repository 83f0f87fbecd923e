// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <utility>

#include "sample.hpp"
#include "triskin/base/error.hpp"
#include "triskin/diagnose/verify.hpp"
#include "triskin/diagnose/verify_report.hpp"
#include "triskin/robot/assembly.hpp"

namespace triskin::library {
namespace {

session::StreamOptions stream_options(const triskin_options& options) {
  session::StreamOptions s;
  s.every = options.every;
  s.overload = options.overload != 0;
  return s;
}

connect::LinkOptions link_options(const triskin_options& options) {
  connect::LinkOptions link;
  link.chosen = options.link != nullptr;
  if (link.chosen) link.link = options.link;
  connect::settle_link(link, options.scene != nullptr);
  if (options.scene != nullptr) link.scene = options.scene;
  link.own_interrupts = false;
  return link;
}

// The time of simulations in this process passes only while a caller waits; that of all others passes by itself.
bool has_virtual_time(const Source& source) {
  std::size_t here = 0;
  const bool by_file = source.site.is_robot && !source.link.chosen;
  for (const robot::BusConfig& bus : source.site.buses)
    here += link::is_in_process(by_file ? bus.link : source.link.link) ? 1 : 0;
  if (here != 0 && here != source.site.buses.size())
    throw InputError(fmt::format(
        "{}: some buses are simulated in this process and some are not; open it with the link sim, or serve "
        "the simulation by triskin simulate",
        source.site.file.string()));
  return here != 0;
}

}  // namespace

Source read_source(const std::string& file, const triskin_options& options) {
  Source source{robot::read_site(file), {}, {}, {}, link_options(options)};
  if (source.site.is_robot) {
    const robot::Assembly assembly = robot::read_assembly(file);
    design::SideBySide joint = robot::in_base(assembly);
    source.design = std::move(joint.design);
    source.offsets = std::move(joint.offsets);
    for (const robot::CoverEntry& cover : assembly.robot.covers) source.covers.push_back(cover.name);
  } else {
    source.design = source.site.buses.front().covers.front().design;
    source.offsets.emplace_back();
    source.covers.push_back(source.design.name);
  }
  if (source.design.layout.modules.empty())
    throw InputError(fmt::format("{}: the design has no modules: there is nothing to read", file));
  return source;
}

namespace {

skin::LiveSkin opened(const Source& source) {
  skin::LiveSkin live(source.site, source.link);
  live.open();
  return live;
}

std::vector<layout::SkinModule> first_modules(const Source& source) {
  std::vector<layout::SkinModule> first;
  for (const design::CoverOffset& offset : source.offsets) first.push_back(offset.module);
  return first;
}

double seconds_of(std::uint64_t unix_ns) {
  return static_cast<double>(unix_ns) * 1e-9;
}

triskin_sample live_sample(const skin::QueuedSample& q) {
  const double error_s =
      q.error_us == session::LinkTime::kUnbounded ? std::numeric_limits<double>::infinity() : q.error_us * 1e-6;
  return sample_of(q.frame, q.module, seconds_of(q.unix_ns), error_s);
}

// Returns the source if its options can be used.
Source checked(Source source, const triskin_options& options) {
  if (options.every < 0 || options.every > 255) throw InputError("every: must be 0 … 255");
  if (!(options.queue_s > 0.0 && options.queue_s <= 600.0))
    throw InputError("queue_s: must be above 0 and at most 600");
  return source;
}

}  // namespace

Skin::Skin(Source source, const triskin_options& options)
    : source_(checked(std::move(source), options)),
      stream_options_(stream_options(options)),
      virtual_time_(has_virtual_time(source_)),
      live_(opened(source_)),
      queue_(live_, first_modules(source_), source_.design.layout.modules.size(), options.queue_s, virtual_time_) {}

std::size_t Skin::read(double timeout_s, triskin_sample* samples, std::size_t capacity) {
  if (!(timeout_s >= 0.0 && timeout_s <= 3600.0)) throw InputError("timeout_s: must be 0 … 3600");
  // After stop(), waiting samples can still be read, and sampling does not start again.
  if (!queue_.started()) start();
  const std::vector<skin::QueuedSample> queued = queue_.read(timeout_s, capacity);
  std::ranges::transform(queued, samples, live_sample);
  return queued.size();
}

double Skin::now_s() const {
  const skin::LiveBus& bus = *live_.buses().front();
  return seconds_of(bus.unix_ns(bus.now_us()));
}

triskin_counts Skin::counts() {
  const session::SampleCounts all = queue_.counts();
  return {.expected = all.expected, .received = all.received, .lost = all.lost(), .lost_here = queue_.dropped()};
}

void Skin::tare() {
  start();
  queue_.tare();
}

std::vector<ModuleCalibration> Skin::calibration() {
  if (queue_.runs()) throw InputError("calibration: stop the stream first (triskin_stop)");
  std::vector<ModuleCalibration> modules(source_.design.layout.modules.size());
  for (const auto& bus : live_.buses()) {
    bus->find_controllers(skin::RestSource::kPresent);
    for (const skin::LiveCover& cover : bus->covers()) calibrate(*bus, cover, modules);
  }
  return modules;
}

void Skin::calibrate(skin::LiveBus& bus, const skin::LiveCover& cover, std::vector<ModuleCalibration>& modules) {
  const design::SkinCalibration skin = bus.find_calibration(cover, {}).skin;
  const layout::SkinModule first = source_.offsets[static_cast<std::size_t>(cover.config().cover)].module;
  if (skin.modules() == 0) return;
  for (const layout::PatchIndex patch : design::patches_here(cover.design())) {
    for (const design::RoutedModule& routed : cover.design().patches[static_cast<std::size_t>(patch)].modules) {
      ModuleCalibration& module = modules.at(static_cast<std::size_t>(first + routed.node));
      module.taxel_area_mm2 = skin.taxel_area_mm2(layout::ModuleId{routed.node});
      module.known = module.taxel_area_mm2 > 0.0;
      for (std::size_t t = 0; t < module.counts_per_kpa.size(); ++t)
        module.counts_per_kpa[t] = skin.counts_per_kpa({layout::ModuleId{routed.node}, layout::TaxelIndex{t}});
    }
  }
}

std::pair<std::string, bool> Skin::verify() {
  if (queue_.runs()) throw InputError("verify: stop the stream first (triskin_stop)");
  std::string report;
  bool good = true;
  for (const auto& bus : live_.buses()) good = verify(*bus, report) && good;
  return {std::move(report), !good};
}

// Verifies the covers one after the other and appends findings. Returns true if there are none.
bool Skin::verify(skin::LiveBus& bus, std::string& report) {
  bool good = true;
  for (skin::LiveCover& cover : bus.covers()) {
    diagnose::VerifyOptions options;
    options.neighbours = robot::other_demands(bus.config(), std::array{&cover.design()});
    const diagnose::VerifyResult result = diagnose::verify(bus.bus(), cover.design(), options);
    if (!cover.config().name.empty()) report += "cover " + cover.config().name + "\n";
    report += diagnose::report_text(cover.design(), result);
    good = good && result.findings.empty();
  }
  return good;
}

}  // namespace triskin::library
