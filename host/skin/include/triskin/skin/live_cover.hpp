// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "triskin/link/touch_actuator.hpp"
#include "triskin/robot/site.hpp"
#include "triskin/session/module_sample.hpp"
#include "triskin/skin/live_monitor.hpp"
#include "triskin/skin/tare.hpp"
#include "triskin/wire/node_claim.hpp"

namespace triskin::device {

/// One sample of one module, in the form in which every reader of a skin gets it. Bit t of `valid` and element t of the
/// arrays belong to taxel t.
struct LiveSample {
  int cover = 0;   ///< index in LiveBus::covers()
  int module = 0;  ///< id in the design of the cover
  /// Pressure: by how many counts each taxel reads below its rest value; 0 where that is not known.
  std::array<double, layout::kTaxelsPerModule> change_counts{};
  /// The same in kPa; empty for a cover without a calibration.
  std::optional<std::array<double, layout::kTaxelsPerModule>> pressure_kpa{};
  std::uint16_t valid = 0;     ///< taxels whose value was measured
  std::uint64_t unix_ns = 0;   ///< when the controller took it, ns since 1970
  std::uint32_t error_us = 0;  ///< bound of the error of that time; LinkTime::kUnbounded: not known yet
  ModuleSample raw{};          ///< counts of the converters and times as they came over the wire
};

/// Where a cover gets its rest values from.
enum class RestSource {
  kKept,     ///< those that a tare or a calibration kept for these controllers on this computer, else the design's
  kNone,     ///< the design's, until a tare
  kPresent,  ///< those that it has already
};

/// A cover of a skin, or its part on one bus: rest values, calibration, pressure, tare. Threads: that of its bus.
class LiveCover {
 public:
  /// `config` and `whole`, the actuator of the bus (null: there is none), outlive it.
  LiveCover(const robot::CoverConfig& config, TouchActuator* whole);
  LiveCover(const LiveCover&) = delete;
  LiveCover& operator=(const LiveCover&) = delete;

  /// What the robot file says of it.
  [[nodiscard]] const robot::CoverConfig& config() const { return config_; }
  /// Its design with the node addresses of this bus.
  [[nodiscard]] const design::Design& design() const { return config_.design; }
  /// Presses modules of the design; null on hardware.
  [[nodiscard]] TouchActuator* actuator() { return actuator_ ? &*actuator_ : nullptr; }

  /// Sets rest values for the controllers `claims`, and forgets calibration and samples; kPresent forgets nothing.
  /// Throws InputError when the kept ones are damaged.
  void set_rest(std::span<const wire::NodeClaim> claims, RestSource source);
  /// Rest values that were kept; empty: there were none.
  [[nodiscard]] const design::RestValues& kept_rest() const { return kept_rest_; }
  /// Keeps the present rest values for the next time; returns their file. Throws InputError when it cannot be written.
  std::filesystem::path keep_rest() const;
  /// Keeps other rest values. Throws as keep_rest().
  void keep_rest(const design::RestValues& rest) const;
  /// Gives samples their pressure in kPa from now on. Ignored unless it is complete.
  void set_calibration(design::SkinCalibration calibration);
  /// Empty without a complete calibration.
  [[nodiscard]] const design::SkinCalibration& calibration() const { return monitor_->calibration(); }

  /// Pressure, states and rates.
  [[nodiscard]] LiveMonitor& monitor() { return *monitor_; }
  [[nodiscard]] const LiveMonitor& monitor() const { return *monitor_; }
  /// Pressure and rest value of every taxel.
  [[nodiscard]] const TouchMap& touches() const { return monitor().touches(); }
  /// Takes a sample and returns it in the common form. `cover`: index of this one. `unix_ns`: calendar time at which it
  /// was taken.
  LiveSample take(const ModuleSample& sample, int cover, std::uint64_t unix_ns);

  /// Begins to take new rest values, also when that is under way; nothing may touch the cover.
  void begin_tare(std::uint64_t now_us) { tare_->begin(now_us); }
  /// The latest tare, and how it ended.
  [[nodiscard]] const Tare& tare() const { return *tare_; }
  /// Lets the tare notice the time. LiveBus::run does that after each slice.
  void step_tare(std::uint64_t now_us) { (void)tare_->step(now_us); }

 private:
  void reset();

  const robot::CoverConfig& config_;
  std::optional<CoverTouchActuator> actuator_;
  std::filesystem::path rest_file_;
  design::RestValues kept_rest_;
  std::optional<LiveMonitor> monitor_;
  std::optional<Tare> tare_;
};

}  // namespace triskin::device
