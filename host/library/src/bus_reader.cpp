// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <utility>

#include "skin.hpp"
#include "triskin/connect/open_bus.hpp"
#include "triskin/diagnose/verify.hpp"
#include "triskin/diagnose/verify_report.hpp"
#include "triskin/link/cover_link.hpp"
#include "triskin/session/controller_calibration.hpp"
#include "triskin/skin/calibrate.hpp"
#include "triskin/skin/rest_store.hpp"

namespace triskin::library {
namespace {

constexpr double kMicros = 1e6;

double wall_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

BusReader::BusReader(const Source& source, std::size_t bus)
    : source_(source),
      site_(source.site.buses[bus]),
      link_(device::open_bus(source.site, bus, source.link)),
      bus_(*link_),
      unix_start_s_(wall_s()),
      link_start_us_(bus_.now_us()) {}

double BusReader::unix_s(std::uint64_t link_us) const {
  const auto since_us = static_cast<std::int64_t>(link_us - link_start_us_);
  return unix_start_s_ + static_cast<double>(since_us) / kMicros;
}

void BusReader::start(const device::StreamOptions& options, OnSample on_sample) {
  std::vector<const design::Design*> covers;
  for (const robot::CoverConfig& cover : site_.covers) covers.push_back(&cover.design);
  stream_ = std::make_unique<device::Stream>(
      bus_, covers,
      [this, on_sample = std::move(on_sample)](const device::ModuleSample& frame) { take(frame, on_sample); },
      robot::stream_options(site_, covers, options));
}

void BusReader::take(const device::ModuleSample& f, const OnSample& on_sample) const {
  const int cover = site_.covers[static_cast<std::size_t>(f.cover)].cover;
  device::ModuleSample frame = f;
  frame.module += source_.offsets[static_cast<std::size_t>(cover)].module;
  triskin_sample s{};
  s.time_s = unix_s(f.sampled.link_us);
  s.error_s = f.sampled.error_us == device::LinkTime::kUnbounded ? std::numeric_limits<double>::infinity()
                                                                 : f.sampled.error_us / kMicros;
  s.device_time_us = f.sample.device_time_us;
  s.number = f.sample.sample;
  s.module = frame.module;
  s.node = f.sample.node_address;
  s.valid = f.sample.valid;
  std::ranges::copy(f.sample.value, std::begin(s.value));
  on_sample(s, frame);
}

void BusReader::stop() {
  if (!stream_) return;
  stream_->finish();
  counts_ = stream_->report().total;
  stream_.reset();
}

void BusReader::set_rest(device::TouchMap& touches) {
  const auto claims = bus_.discover();
  for (const robot::CoverConfig& cover : site_.covers)
    touches.set_rest(device::RestStore(cover.design, claims).read(),
                     source_.offsets[static_cast<std::size_t>(cover.cover)].module);
}

void BusReader::calibrate(std::vector<ModuleCalibration>& modules) {
  const auto claims = bus_.discover();
  const device::CalibrationStore store;
  for (const robot::CoverConfig& cover : site_.covers) {
    const design::SkinCalibration skin =
        device::calibration_of(cover.design, claims, {}, device::kept_in_controllers(bus_, cover.design, claims), store)
            .skin;
    const int first = source_.offsets[static_cast<std::size_t>(cover.cover)].module;
    if (skin.modules() == 0) continue;
    for (const int patch : design::patches_here(cover.design)) {
      for (const design::RoutedModule& routed : cover.design.patches[static_cast<std::size_t>(patch)].modules) {
        ModuleCalibration& module = modules.at(static_cast<std::size_t>(first + routed.node));
        module.taxel_area_mm2 = skin.taxel_area_mm2(routed.node);
        module.known = module.taxel_area_mm2 > 0.0;
        for (std::size_t t = 0; t < module.counts_per_kpa.size(); ++t)
          module.counts_per_kpa[t] = skin.counts_per_kpa(routed.node, static_cast<int>(t));
      }
    }
  }
}

bool BusReader::verify(std::string& report) {
  bool good = true;
  for (const robot::CoverConfig& cover : site_.covers) {
    device::CoverLink own(*link_, cover.first_module);
    device::Bus bus(own);
    device::VerifyOptions options;
    options.neighbours = robot::other_demands(site_, std::array{&cover.design});
    const device::VerifyResult result = device::verify(bus, cover.design, options);
    if (!cover.name.empty()) report += "cover " + cover.name + "\n";
    report += device::report_text(cover.design, result);
    good = good && result.findings.empty();
  }
  return good;
}

}  // namespace triskin::library
