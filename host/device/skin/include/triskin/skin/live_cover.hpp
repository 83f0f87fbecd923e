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

namespace triskin::skin {

/// All readers of a skin receive samples in this form, one module each. Bit t of `valid` and element t of the arrays
/// belong to taxel t.
struct LiveSample {
  layout::CoverIndex cover;  ///< The number is an index in LiveBus::covers().
  layout::ModuleId module;   ///< The id belongs to the design of the cover.
  /// Pressure lowers a taxel below its rest value by this many counts; 0 where the rest value is not known.
  std::array<double, layout::kTaxelsPerModule> change_counts{};
  /// The pressure is given in kPa as well; empty for a cover without a calibration.
  std::optional<std::array<double, layout::kTaxelsPerModule>> pressure_kpa{};
  std::uint16_t valid = 0;    ///< Bit t is set if the value of taxel t was measured.
  std::uint64_t unix_ns = 0;  ///< The controller took the sample at this time, in ns since 1970.
  /// The time has at most this error; LinkTime::kUnbounded means that it is not known yet.
  std::uint32_t error_us = 0;
  session::ModuleSample raw{};  ///< The sample as received has the converters' counts and the controller's times.
};

/// A cover gets its rest values from one of these sources.
enum class RestSource {
  /// A tare or a calibration stored them on this computer for these controllers; otherwise as kNone.
  kKept,
  kNone,     ///< Until a tare, the first values and the controllers say where the taxels rest (TouchMap).
  kPresent,  ///< The cover keeps the values that it has.
};

/// A cover of a skin, or its part on one bus, has rest values, calibration, pressure and tare. Use it in the thread of
/// its bus.
class LiveCover {
 public:
  /// `config` and `whole`, the actuator of the bus (may be null), must outlive the cover.
  LiveCover(const robot::CoverConfig& config, link::TouchActuator* whole);
  LiveCover(const LiveCover&) = delete;
  LiveCover& operator=(const LiveCover&) = delete;

  /// Returns the entry of the cover in the robot file.
  [[nodiscard]] const robot::CoverConfig& config() const { return config_; }
  /// Returns the design with the node addresses of this bus.
  [[nodiscard]] const design::Design& design() const { return config_.design; }
  /// Returns the actuator that presses modules of the design; null on hardware.
  [[nodiscard]] link::TouchActuator* actuator() { return actuator_ ? &*actuator_ : nullptr; }

  /// Sets the rest values for the controllers `claims` and discards calibration and samples; kPresent discards nothing.
  /// Throws InputError when the stored values are damaged.
  void set_rest(std::span<const wire::NodeClaim> claims, RestSource source);
  /// Passes on what the controllers say of the rest (TouchMap::settle).
  void settle(const design::RestValues& settled) {
    rest_.settled = settled;
    monitor_->touches().settle(settled);
  }
  /// Returns what the controllers said of the rest; empty if they were not asked.
  [[nodiscard]] const design::RestValues& settled() const { return rest_.settled; }
  /// Returns the stored rest values; empty if there were none.
  [[nodiscard]] const design::RestValues& kept_rest() const { return rest_.kept; }
  /// Stores the present rest values for the next start and returns their file. Throws InputError when it cannot be
  /// written.
  std::filesystem::path keep_rest() const;
  /// Stores the given rest values. Throws as keep_rest().
  void keep_rest(const design::RestValues& rest) const;
  /// Makes samples contain their pressure in kPa from now on. The call has no effect unless the calibration is
  /// complete.
  void set_calibration(design::SkinCalibration calibration);
  /// Returns the calibration, which is empty unless it is complete.
  [[nodiscard]] const design::SkinCalibration& calibration() const { return monitor_->calibration(); }

  /// Returns the monitor of pressure, states and rates.
  [[nodiscard]] LiveMonitor& monitor() { return *monitor_; }
  [[nodiscard]] const LiveMonitor& monitor() const { return *monitor_; }
  /// Returns the map of pressure and rest value of every taxel.
  [[nodiscard]] const TouchMap& touches() const { return monitor().touches(); }
  /// Handles a sample and returns it in the common form. `cover` is the index of this cover, `unix_ns` the calendar
  /// time at which the sample was taken.
  LiveSample take(const session::ModuleSample& sample, layout::CoverIndex cover, std::uint64_t unix_ns);

  /// Starts to take new rest values, again if a tare is already running; nothing may touch the cover.
  void begin_tare(std::uint64_t now_us) { tare_->begin(now_us); }
  /// Returns the latest tare with its outcome.
  [[nodiscard]] const Tare& tare() const { return *tare_; }
  /// Lets the tare check the time. LiveBus::run calls this after each slice.
  void step_tare(std::uint64_t now_us) { (void)tare_->step(now_us); }

 private:
  void reset();

  const robot::CoverConfig& config_;
  std::optional<link::CoverTouchActuator> actuator_;
  std::filesystem::path rest_file_;
  design::KnownRest rest_;
  std::optional<LiveMonitor> monitor_;
  std::optional<Tare> tare_;
};

}  // namespace triskin::skin
