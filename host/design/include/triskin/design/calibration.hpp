// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "triskin/base/names.hpp"
#include "triskin/design/design.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/wire/calibration.hpp"

/// What the counts of taxels are worth in kPa and N (docs/calibration.md).
namespace triskin::design {

/// Pressure in kPa on an area in mm² is a force in newtons by this factor.
inline constexpr double kNewtonPerKpaMm2 = 1e-3;

/// Names in files and reports.
inline constexpr NameTable kCalibrationMethodNames{
    std::array<std::pair<wire::CalibrationMethod, std::string_view>, 3>{{{wire::CalibrationMethod::kSteps, "steps"},
                                                                         {wire::CalibrationMethod::kWeights, "weights"},
                                                                         {wire::CalibrationMethod::kRamp, "ramp"}}}};

/// Response of one taxel to pressure: change in counts = counts_per_kpa · kPa.
struct TaxelSensitivity {
  double counts_per_kpa = 0.0;  ///< It is positive; 0 means that the taxel is not calibrated.
  /// It bounds the relative error of counts_per_kpa by two standard errors and the gauge's.
  double error_percent = 0.0;
  double residual_kpa = 0.0;  ///< No mean of the calibration lies farther from the line.
  bool operator==(const TaxelSensitivity&) const = default;
};

/// The taxels of the module at one place of a controller.
struct PlaceCalibration {
  int line = 0, address = 0;  ///< Each ranges from 0 to 3.
  std::array<TaxelSensitivity, layout::kTaxelsPerModule> taxels{};
  bool operator==(const PlaceCalibration&) const = default;
};

/// The calibration of the modules that hang on one controller. It belongs to these modules and their skin.
struct BoardCalibration {
  std::string serial;           ///< It is the controller's unique id in 24 hexadecimal digits.
  std::uint64_t design_id = 0;  ///< The controller had this design at the time of the calibration.
  int patch = 0;                ///< It is counted from 0 in that design.
  int revision = 1;             ///< It starts at 1 and rises by one with each calibration of this controller.
  std::string made;             ///< It is the time in UTC, as in "2026-11-22T17:30:00Z".
  wire::CalibrationMethod method = wire::CalibrationMethod::kSteps;
  double max_kpa = 0;           ///< Nothing was measured beyond this, the largest pressure that was applied.
  double taxel_area_mm2 = 0.0;  ///< A taxel for pressure stands for so much skin, > 0.
  std::vector<PlaceCalibration> places;
  bool operator==(const BoardCalibration&) const = default;

  /// Calibration of the module at a line and an address; null: it has none. Valid while `places` stays as it is.
  [[nodiscard]] const PlaceCalibration* at(int line, int address) const;
};

/// Text of a calibration file, format "triskin-calibration".
[[nodiscard]] std::string calibration_text(std::span<const BoardCalibration> boards);
/// Reads the text of such a file; `name` stands in messages. Throws InputError naming file, place and remedy: another
/// format or version, values out of range, a board or place that stands twice. Cost: linear.
[[nodiscard]] std::vector<BoardCalibration> parse_calibration(const std::string& text, const std::string& name);
/// The same of a file.
[[nodiscard]] std::vector<BoardCalibration> read_calibration(const std::filesystem::path& path);

/// How good the calibration of several taxels is, over those that have one.
struct CalibrationQuality {
  std::size_t taxels = 0;       ///< It counts the calibrated taxels.
  std::size_t missing = 0;      ///< It counts the pressure taxels that are not calibrated.
  double median_percent = 0.0;  ///< It is the median of error_percent.
  double worst_percent = 0.0;   ///< It is the largest error_percent.
  double residual_kpa = 0.0;    ///< It is the largest residual.
  double max_kpa = 0.0;         ///< It is the least of the boards' largest pressures.
};
/// Quality over all places of `boards`. Cost: O(n log n) in taxels.
[[nodiscard]] CalibrationQuality quality_of(std::span<const BoardCalibration> boards);

/// The calibration of a skin by module of its design. Immutable; threads: any.
class SkinCalibration {
 public:
  /// None: numbers are counts.
  SkinCalibration() = default;
  /// `serial_of_patch` names the controller of a patch (0-based), empty: not known. A module whose controller or place
  /// has no calibration in `boards` has none. Throws std::out_of_range as wiring_of. Cost: O(modules).
  SkinCalibration(const Design& design, std::span<const BoardCalibration> boards,
                  const std::function<std::string(int)>& serial_of_patch);

  /// Every module of the patches on the bus in hand has a calibration, so pressures and forces can be told. A taxel
  /// without one, which did not answer, counts as not pressed.
  [[nodiscard]] bool complete() const { return !modules_.empty() && missing_ == 0; }
  /// Modules of the design; 0 where there is no calibration at all.
  [[nodiscard]] std::size_t modules() const { return modules_.size(); }
  /// Modules without a calibration; 0 where there is none at all.
  [[nodiscard]] std::size_t missing() const { return missing_; }
  /// Sensitivity of taxel 0 … 11 of a module, counts/kPa; 0: not calibrated. Throws std::out_of_range.
  [[nodiscard]] double counts_per_kpa(int module, int taxel) const;
  /// Skin that a taxel of the module stands for, mm²; 0: not calibrated. Throws std::out_of_range.
  [[nodiscard]] double taxel_area_mm2(int module) const {
    return modules_.at(static_cast<std::size_t>(module)).area_mm2;
  }
  /// Pressure of a taxel that reads `change_counts` below rest, kPa; 0 where it is not calibrated. Throws
  /// std::out_of_range.
  [[nodiscard]] double pressure_kpa(int module, int taxel, double change_counts) const;
  /// Force on the skin that this taxel stands for, against its normal, N. Throws std::out_of_range.
  [[nodiscard]] double force_n(int module, int taxel, double change_counts) const;
  /// The boards that it was made of and that the design uses.
  [[nodiscard]] const std::vector<BoardCalibration>& boards() const { return boards_; }

 private:
  struct Module {
    double area_mm2 = 0.0;  // It is 0 where nothing is calibrated.
    std::array<double, layout::kTaxelsPerModule> counts_per_kpa{};
  };
  std::vector<Module> modules_;
  std::vector<BoardCalibration> boards_;
  std::size_t missing_ = 0;
};

}  // namespace triskin::design
