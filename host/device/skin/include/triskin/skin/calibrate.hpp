// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/base/progress.hpp"
#include "triskin/design/calibration.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/layout/taxel_id.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/stream_options.hpp"
#include "triskin/skin/touch_map.hpp"

/// Calibrates a skin from pressures that are known (docs/calibration.md).
namespace triskin::skin {

/// A taxel reads this value under one pressure.
struct CalibrationPoint {
  double pressure_kpa = 0.0;
  double value_counts = 0.0;  ///< The value is a mean; pressure lowers it.
  double samples = 0.0;       ///< The mean covers this many samples (> 0), which serve as its weight.
};
/// The line is fitted through calibration points.
struct SensitivityLine {
  design::TaxelSensitivity sensitivity;
  /// Without pressure the taxel reads this: the point at 0 kPa if there is one, else the line's value there.
  double rest_counts = 0.0;
};
/// Fits a line by least squares: counts_per_kpa is its slope, and the error is the 95 % bound of the slope from the
/// scatter of the points (Student's t). Returns nullopt if there are fewer than three different pressures or the values
/// do not fall. Cost: linear.
[[nodiscard]] std::optional<SensitivityLine> fit_sensitivity(std::span<const CalibrationPoint> points);

/// A pressure that is held constant while samples are taken.
struct PressureStep {
  double pressure_kpa = 0.0;                           ///< Pressures are not negative.
  layout::ModuleId module = layout::ModuleId::none();  ///< The pressure acts on this module; −1 means on all.
};
/// Returns the steps of a calibration: first rest, then each pressure on each of `modules` in turn, or on all modules
/// at once if `modules` is empty.
[[nodiscard]] std::vector<PressureStep> pressure_steps(std::span<const double> pressures_kpa,
                                                       std::span<const layout::ModuleId> modules);

/// A gauge recorded this varying pressure on the whole skin.
class PressureRamp {
 public:
  /// Reads a CSV file of two columns: "time_s,kpa" (times of the link, as in a scene) or "unix_s,kpa" (s since 1970).
  /// Throws InputError naming file, line and remedy: other columns, times that do not rise, fewer than two lines.
  explicit PressureRamp(const std::filesystem::path& file);
  /// Returns true if times are s since 1970; otherwise they are times of the link.
  [[nodiscard]] bool by_calendar() const { return by_calendar_; }
  [[nodiscard]] double first_s() const { return points_.front().first; }
  [[nodiscard]] double last_s() const { return points_.back().first; }
  /// Returns the largest pressure in kPa.
  [[nodiscard]] double max_kpa() const;
  /// Warns that the file's last line may have been cut; the text is empty if there is nothing to report.
  [[nodiscard]] const std::string& note() const { return note_; }
  /// Pressure at a time, between two lines linear; nullopt outside them.
  [[nodiscard]] std::optional<double> kpa(double time_s) const;

 private:
  std::vector<std::pair<double, double>> points_;  // Pairs of time (s) and pressure (kPa).
  std::string note_;
  bool by_calendar_ = false;
};

struct CalibrateOptions {
  double settle_s = 0.5;  ///< Samples do not count for this long after a step, so that the skin can settle.
  double hold_s = 1.0;    ///< Samples of a step count for this long (> 0).
  /// The error of the pressures themselves is added to that of every taxel.
  double gauge_percent = 0.0;
  double max_error_percent = 10.0;       ///< A taxel with a larger error is not calibrated.
  std::uint64_t unix_minus_link_ns = 0;  ///< Ramps by calendar need the calendar time at which the link's time was 0.
  session::StreamOptions stream;         ///< These options decide how samples are read.
  /// The calibration states by which method it was made.
  wire::CalibrationMethod method = wire::CalibrationMethod::kSteps;
  std::vector<layout::ModuleId> modules;  ///< Only these modules are calibrated, in ascending order; empty means all.
  /// The function applies a step and returns when the pressure is steady. It may throw Cancelled.
  std::function<void(const PressureStep&)> apply;
  ProgressSink progress;
};

/// Returns the modules that these options calibrate, in ascending order: the given ones, or all of the patches on this
/// bus.
[[nodiscard]] std::vector<layout::ModuleId> wanted_modules(const design::Design& design,
                                                           const CalibrateOptions& options);

struct CalibrationOutcome {
  /// These modules were measured, in ascending order. Boards without one of them are left out, and so are the places of
  /// all other modules.
  std::vector<layout::ModuleId> measured;
  /// Revision is 1 and `made` is empty, because the store sets both.
  std::vector<design::BoardCalibration> boards;
  design::RestValues rest;               ///< Rest values are those of the taxels without pressure.
  std::vector<layout::TaxelId> without;  ///< These pressure taxels could not be calibrated.
  design::CalibrationQuality quality;
};
/// Takes samples at each step and fits every taxel. If a person ends it (Cancelled), modules whose steps are all done
/// count as measured; if there are none, Cancelled is thrown. Throws as Stream does, and InputError for fewer than
/// three different pressures. Cost: settle_s + hold_s of the link's time per step.
[[nodiscard]] CalibrationOutcome calibrate_by_steps(session::Bus& bus, const design::Design& design,
                                                    std::span<const PressureStep> steps,
                                                    const CalibrateOptions& options);
/// Takes samples from now until the ramp ends and fits every taxel to the pressures at the sampling times. Throws as
/// Stream does, and InputError when the ramp has already ended.
[[nodiscard]] CalibrationOutcome calibrate_by_ramp(session::Bus& bus, const design::Design& design,
                                                   const PressureRamp& ramp, const CalibrateOptions& options);

/// This computer stores calibrations in one file for each controller, named by its serial number.
class CalibrationStore {
 public:
  /// Stores files in `folder`; an empty path means state_home()/calibration.
  explicit CalibrationStore(std::filesystem::path folder = {});
  /// Reads the calibration of a controller; nullopt: there is none. Throws InputError for a damaged file.
  [[nodiscard]] std::optional<design::BoardCalibration> read(const std::string& serial) const;
  /// Stores the calibration unchanged and replaces an older one. Throws InputError when the file cannot be written,
  /// also when another program locks it for more than two seconds.
  void write(const design::BoardCalibration& board) const;
  /// Stores a new calibration. Its revision is one above both the stored one and `before`, the revision in the
  /// controller (0: none); `made` is the present time. Returns what was written.
  design::BoardCalibration renew(design::BoardCalibration board, int before = 0) const;
  /// Deletes the calibration of a controller; returns false if there was none.
  bool forget(const std::string& serial) const;

 private:
  [[nodiscard]] std::filesystem::path file_of(const std::string& serial) const;
  void replace(const design::BoardCalibration& board) const;
  std::filesystem::path folder_;
};

/// The search for a skin's calibration gives this result.
struct FoundCalibration {
  design::SkinCalibration skin;
  /// This many controllers use the calibration that they store themselves.
  std::size_t in_controllers = 0;
  /// These calibrations belong to the same controllers but were made when they served another patch or design, that is
  /// other modules; they are not used.
  std::vector<design::BoardCalibration> of_others;
};
/// Finds the calibration of a design for the controllers `claims` of its bus. `boards` has priority, whatever design
/// they were made with; then `kept`, which the controllers store themselves (kept_in_controllers); then `store`. If
/// `store` has the same calibration as the controller, it is used instead, because it has the error of each taxel.
/// Throws as CalibrationStore::read.
[[nodiscard]] FoundCalibration calibration_of(const design::Design& design, std::span<const wire::NodeClaim> claims,
                                              std::span<const design::BoardCalibration> boards,
                                              std::span<const design::BoardCalibration> kept,
                                              const CalibrationStore& store);

}  // namespace triskin::skin
