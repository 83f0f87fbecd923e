// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/skin/live_cover.hpp"

#include "rest_store.hpp"

namespace triskin::skin {

LiveCover::LiveCover(const robot::CoverConfig& config, link::TouchActuator* whole) : config_(config) {
  if (whole != nullptr) actuator_.emplace(*whole, config.first_module);
  reset();
}

void LiveCover::set_rest(std::span<const wire::NodeClaim> claims, RestSource source) {
  const RestStore store(design(), claims);
  rest_file_ = store.file();
  if (source == RestSource::kPresent) return;
  rest_ = {source == RestSource::kKept ? store.read() : design::RestValues{}, {}};
  reset();
}

void LiveCover::reset() {
  tare_.reset();
  monitor_.emplace(design(), rest_);
  tare_.emplace(monitor_->touches(), design().layout.modules.size());
}

std::filesystem::path LiveCover::keep_rest() const {
  keep_rest(touches().rest());
  return rest_file_;
}

void LiveCover::keep_rest(const design::RestValues& rest) const {
  RestStore(rest_file_, design().layout.modules.size()).write(rest);
}

void LiveCover::set_calibration(design::SkinCalibration calibration) {
  if (calibration.complete()) monitor_->set_calibration(std::move(calibration));
}

LiveSample LiveCover::take(const session::ModuleSample& sample, layout::CoverIndex cover, std::uint64_t unix_ns) {
  monitor_->add(sample);
  tare_->add(sample);
  LiveSample live{
      cover, sample.module, touches().change(sample.module), {}, sample.sample.valid, unix_ns, sample.sampled.error_us,
      sample};
  if (!calibration().complete()) return live;
  auto& pressure_kpa = live.pressure_kpa.emplace();
  for (std::size_t t = 0; t < pressure_kpa.size(); ++t)
    pressure_kpa[t] = calibration().pressure_kpa({sample.module, layout::TaxelIndex{t}}, live.change_counts[t]);
  return live;
}

}  // namespace triskin::skin
