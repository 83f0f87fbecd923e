// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/base/names.hpp"
#include "triskin/design/design.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/layout/taxel_id.hpp"
#include "triskin/wire/calibration.hpp"

/// Converts the counts of taxels into kPa and N (docs/calibration.md).
namespace triskin::design {

/// A pressure in kPa times an area in mm² times this factor is a force in newtons.
inline constexpr double kNewtonPerKpaMm2 = 1e-3;

/// Files and reports use these names.
inline constexpr NameTable kCalibrationMethodNames{
    std::array<std::pair<wire::CalibrationMethod, std::string_view>, 3>{{{wire::CalibrationMethod::kSteps, "steps"},
                                                                         {wire::CalibrationMethod::kWeights, "weights"},
                                                                         {wire::CalibrationMethod::kRamp, "ramp"}}}};

/// A taxel responds to pressure linearly: the change in counts is counts_per_kpa · kPa.
struct TaxelSensitivity {
  double counts_per_kpa = 0.0;  ///< The value is positive; 0 means that the taxel is not calibrated.
  /// The bound on the relative error of counts_per_kpa covers two standard errors and the error of the gauge.
  double error_percent = 0.0;
  double residual_kpa = 0.0;  ///< No mean of the calibration deviates more from the fitted line.
  bool operator==(const TaxelSensitivity&) const = default;
};

/// The taxels of the module at one place of a controller are calibrated together.
struct PlaceCalibration {
  int line = 0, address = 0;  ///< Valid values are 0 to 3.
  std::array<TaxelSensitivity, layout::kTaxelsPerModule> taxels{};
  bool operator==(const PlaceCalibration&) const = default;
};

/// A calibration belongs to the modules that are connected to one controller. It is only valid for these modules and
/// their skin.
struct BoardCalibration {
  std::string serial;           ///< The controller's unique id is written in 24 hexadecimal digits.
  std::uint64_t design_id = 0;  ///< The controller had this design at the time of the calibration.
  layout::PatchIndex patch;     ///< The controller had the table of this patch of that design.
  int revision = 1;             ///< The revision starts at 1 and rises by one with each calibration of this controller.
  std::string made;             ///< The time is in UTC, as in "2026-11-22T17:30:00Z".
  wire::CalibrationMethod method = wire::CalibrationMethod::kSteps;
  double max_kpa = 0;           ///< Nothing was measured above this, the largest pressure that was applied.
  double taxel_area_mm2 = 0.0;  ///< Each pressure taxel represents this area of skin, > 0.
  std::vector<PlaceCalibration> places;
  bool operator==(const BoardCalibration&) const = default;

  /// Returns the calibration of the module at a line and an address, or null. It is valid while `places` does not
  /// change.
  [[nodiscard]] const PlaceCalibration* at(int line, int address) const;
};

/// Formats calibrations as a file of format "triskin-calibration".
[[nodiscard]] std::string calibration_text(std::span<const BoardCalibration> boards);
/// Parses such a file; `name` appears in messages. Throws InputError naming file, place and remedy: another format or
/// version, values out of range, a board or place that occurs twice. Cost: linear.
[[nodiscard]] std::vector<BoardCalibration> parse_calibration(const std::string& text, const std::string& name);
/// Reads such a file and throws as parse_calibration() does.
[[nodiscard]] std::vector<BoardCalibration> read_calibration(const std::filesystem::path& path);

/// The quality summarizes the calibration of several taxels; only calibrated ones count.
struct CalibrationQuality {
  std::size_t taxels = 0;
  std::size_t missing = 0;      ///< Only pressure taxels that are not calibrated count.
  double median_percent = 0.0;  ///< The median is taken over error_percent of the calibrated taxels.
  double worst_percent = 0.0;   ///< The worst taxel has the largest error_percent.
  double residual_kpa = 0.0;    ///< The worst residual of any taxel is given.
  double max_kpa = 0.0;         ///< All boards are calibrated at least up to this pressure.
};
/// Summarizes all places of `boards`. Cost: O(n log n) in taxels.
[[nodiscard]] CalibrationQuality quality_of(std::span<const BoardCalibration> boards);

/// A calibration of a skin is indexed by module of its design. Immutable; threads: any.
class SkinCalibration {
 public:
  /// Makes an empty calibration, with which values stay in counts.
  SkinCalibration() = default;
  /// `serial_of_patch` returns the serial number of the controller of a patch (0-based), or an empty text if it is not
  /// known. A module is not calibrated if `boards` lacks its controller or place. Throws std::out_of_range as
  /// wiring_of. Cost: O(modules).
  SkinCalibration(const Design& design, std::span<const BoardCalibration> boards,
                  const std::function<std::string(layout::PatchIndex)>& serial_of_patch);

  /// Returns true if every module of the patches on this bus has a calibration, so that pressures and forces can be
  /// computed. A single taxel without one, because it did not answer, counts as not pressed.
  [[nodiscard]] bool complete() const { return !modules_.empty() && missing_ == 0; }
  /// Returns the number of modules in the design, or 0 if nothing is calibrated.
  [[nodiscard]] std::size_t modules() const { return modules_.size(); }
  /// Returns the number of modules without a calibration, or 0 if nothing is calibrated.
  [[nodiscard]] std::size_t missing() const { return missing_; }
  /// Returns the sensitivity in counts/kPa; 0 if the taxel is not calibrated. Throws std::out_of_range.
  [[nodiscard]] double counts_per_kpa(layout::TaxelId taxel) const;
  /// Returns the area of skin in mm² that a taxel of the module represents; 0 if it is not calibrated. Throws
  /// std::out_of_range.
  [[nodiscard]] double taxel_area_mm2(layout::ModuleId module) const {
    return modules_.at(static_cast<std::size_t>(module)).area_mm2;
  }
  /// Returns the pressure in kPa of a taxel that reads `change_counts` below rest; 0 if it is not calibrated. Throws
  /// std::out_of_range.
  [[nodiscard]] double pressure_kpa(layout::TaxelId taxel, double change_counts) const;
  /// Returns the force in N on the skin that this taxel represents, against its normal. Throws std::out_of_range.
  [[nodiscard]] double force_n(layout::TaxelId taxel, double change_counts) const;
  /// Returns true if a taxel that reads `change_counts` below rest is pressed more than anything with which its module
  /// was calibrated, so that nobody knows whether the line still holds. Throws std::out_of_range.
  [[nodiscard]] bool is_above_range(layout::TaxelId taxel, double change_counts) const;
  /// Returns those of the given boards that the design uses.
  [[nodiscard]] const std::vector<BoardCalibration>& boards() const { return boards_; }

 private:
  struct Module {
    double area_mm2 = 0.0;  // Zero means that no taxel is calibrated.
    double max_kpa = 0.0;
    std::array<double, layout::kTaxelsPerModule> counts_per_kpa{};
  };
  std::vector<Module> modules_;
  std::vector<BoardCalibration> boards_;
  std::size_t missing_ = 0;
};

}  // namespace triskin::design
