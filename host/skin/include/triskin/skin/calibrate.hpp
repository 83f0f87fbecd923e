// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "triskin/design/calibration.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/stream_options.hpp"
#include "triskin/skin/touch_map.hpp"

/// Makes calibrations of a skin, from pressures that are known (docs/calibration.md).
namespace triskin::device {

/// What a taxel read under one pressure.
struct CalibrationPoint {
  double pressure_kpa = 0.0;
  double value_counts = 0.0;  ///< It is a mean, and pressure lowers it.
  double samples = 0.0;       ///< The mean has so many samples (> 0), which are its weight.
};
/// A line through such points.
struct SensitivityLine {
  design::TaxelSensitivity sensitivity;
  double rest_counts = 0.0;  ///< It is the value without pressure: the point at 0 kPa, else where the line meets it.
};
/// The line of least squares: counts_per_kpa is its slope, the error the 95 % bound of the slope by the scatter of the
/// points (Student's t). nullopt: fewer than three different pressures, or the values do not fall. Cost: linear.
[[nodiscard]] std::optional<SensitivityLine> fit_sensitivity(std::span<const CalibrationPoint> points);

/// A pressure that stands still while samples are taken.
struct PressureStep {
  double pressure_kpa = 0.0;  ///< It is not negative.
  int module = -1;            ///< It is the module under the pressure; −1 stands for all.
};
/// The steps of a calibration: rest, then each pressure on all modules, or (`by_module`) on each module in turn.
[[nodiscard]] std::vector<PressureStep> pressure_steps(std::span<const double> pressures_kpa, bool by_module,
                                                       std::size_t modules);

/// A pressure on the whole skin that a gauge has noted.
class PressureRamp {
 public:
  /// Reads a CSV file of two columns: "time_s,kpa" (times of the link, as of a scene) or "unix_s,kpa" (s since 1970).
  /// Throws InputError naming file, line and remedy: other columns, times that do not rise, fewer than two lines.
  explicit PressureRamp(const std::filesystem::path& file);
  /// Times are s since 1970; else those of the link.
  [[nodiscard]] bool by_calendar() const { return by_calendar_; }
  [[nodiscard]] double first_s() const { return points_.front().first; }
  [[nodiscard]] double last_s() const { return points_.back().first; }
  /// Largest pressure, kPa.
  [[nodiscard]] double max_kpa() const;
  /// What is to be said about the file: its last line may have been cut. Empty: nothing.
  [[nodiscard]] const std::string& note() const { return note_; }
  /// Pressure at a time, between two lines linear; nullopt outside them.
  [[nodiscard]] std::optional<double> kpa(double time_s) const;

 private:
  std::vector<std::pair<double, double>> points_;  // Pairs of time (s) and pressure (kPa).
  std::string note_;
  bool by_calendar_ = false;
};

struct CalibrateOptions {
  double settle_s = 0.5;  ///< A step is left alone for so long before samples count.
  double hold_s = 1.0;    ///< Samples of a step count for so long (> 0).
  /// It is the error of the pressures themselves, which is added to that of every taxel.
  double gauge_percent = 0.0;
  double max_error_percent = 10.0;       ///< A taxel with a larger error is left without a calibration.
  std::uint64_t unix_minus_link_ns = 0;  ///< It is the calendar time of the link's time 0, for ramps by calendar.
  StreamOptions stream;                  ///< It says how samples are read.
  wire::CalibrationMethod method = wire::CalibrationMethod::kSteps;  ///< The calibration states this method.
  std::function<void(const PressureStep&)> apply;  ///< It applies a step and returns when the pressure is steady.
};

/// A calibration of a skin.
struct CalibrationOutcome {
  /// They have revision 1 and an empty `made`, because the store sets both.
  std::vector<design::BoardCalibration> boards;
  design::RestValues rest;                   ///< Each is the value of a taxel without pressure.
  std::vector<std::pair<int, int>> without;  ///< Each is a module and a taxel for pressure that is not calibrated.
  design::CalibrationQuality quality;
};
/// Takes samples at each step and fits every taxel. Throws as Stream does, InputError for fewer than three different
/// pressures. Cost: settle_s + hold_s of the link's time a step.
[[nodiscard]] CalibrationOutcome calibrate_by_steps(Bus& bus, const design::Design& design,
                                                    std::span<const PressureStep> steps,
                                                    const CalibrateOptions& options);
/// Takes samples from now to the end of the ramp and fits every taxel to the pressures of the moments at which they
/// were taken. Throws as Stream does; InputError when the ramp has ended already.
[[nodiscard]] CalibrationOutcome calibrate_by_ramp(Bus& bus, const design::Design& design, const PressureRamp& ramp,
                                                   const CalibrateOptions& options);

/// The calibrations that this computer keeps, a file for each controller, by its serial number.
class CalibrationStore {
 public:
  /// Keeps them in `folder`; empty: state_home()/calibration.
  explicit CalibrationStore(std::filesystem::path folder = {});
  /// Calibration of a controller; nullopt: there is none. Throws InputError for a file that is damaged.
  [[nodiscard]] std::optional<design::BoardCalibration> read(const std::string& serial) const;
  /// Keeps it as it is, in place of an older one. Throws InputError when the file cannot be written, also
  /// when another program holds it for more than two seconds.
  void write(const design::BoardCalibration& board) const;
  /// Keeps a new one: its revision is one more than that of what is there and than `before`, that of what its
  /// controller keeps (0: nothing); `made` is now. Returns what was written.
  design::BoardCalibration renew(design::BoardCalibration board, int before = 0) const;
  /// Forgets that of a controller; false: there was none.
  bool forget(const std::string& serial) const;

 private:
  [[nodiscard]] std::filesystem::path file_of(const std::string& serial) const;
  void replace(const design::BoardCalibration& board) const;
  std::filesystem::path folder_;
};

/// What is known of a skin's calibration.
struct FoundCalibration {
  design::SkinCalibration skin;
  /// Controllers whose own calibration is used.
  std::size_t in_controllers = 0;
  /// Kept for its controllers, but made when they served another patch or design, so of other modules: not used.
  std::vector<design::BoardCalibration> of_others;
};
/// The calibration of a design on the controllers `claims` of its bus: of `boards`, whatever design they were made
/// with, where they have the controller, else of `kept`, what the controllers keep themselves (kept_in_controllers),
/// else what `store` keeps. Where `store` has the very calibration that the controller keeps, it is taken from there:
/// its errors are those of each taxel. Throws as CalibrationStore::read.
[[nodiscard]] FoundCalibration calibration_of(const design::Design& design, std::span<const wire::NodeClaim> claims,
                                              std::span<const design::BoardCalibration> boards,
                                              std::span<const design::BoardCalibration> kept,
                                              const CalibrationStore& store);

}  // namespace triskin::device
