// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "triskin/design/calibration.hpp"
#include "triskin/design/off_rest.hpp"
#include "triskin/skin/skin_contacts.hpp"
#include "triskin/skin/touch_map.hpp"
#include "triskin/wire/module_state.hpp"

namespace triskin::skin {

/// The numbers in the picture of a patch have one of these units.
enum class PressureUnit {
  kCounts,   ///< The unit is the converter's count.
  kPercent,  ///< The unit is a percentage of the counts between rest and the end of the range.
  kKpa,      ///< The calibration gives kPa, and 0 where there is none.
  kModule,   ///< Each cell shows the number of its module; its colour shows the pressure.
};

/// What is known of a skin while its samples come: pressure, states, rates; and its picture as text. Not thread-safe.
class LiveMonitor {
 public:
  /// `design` must outlive the monitor. `rest` is passed to TouchMap.
  explicit LiveMonitor(const design::Design& design, const design::KnownRest& rest = {},
                       design::SkinCalibration calibration = {});
  /// Updates the state of a module with a sample.
  void add(const session::ModuleSample& frame);
  [[nodiscard]] TouchMap& touches() { return touches_; }
  [[nodiscard]] const TouchMap& touches() const { return touches_; }
  /// Converts counts by this calibration from now on.
  void set_calibration(design::SkinCalibration calibration) { calibration_ = std::move(calibration); }
  /// Returns the calibration that converts counts.
  [[nodiscard]] const design::Design& design() const { return design_; }
  [[nodiscard]] const design::SkinCalibration& calibration() const { return calibration_; }
  /// Returns the present contacts, the strongest first (skin_contacts.hpp). Cost: some ms for each contact.
  [[nodiscard]] std::vector<SkinContact> contacts() const;
  /// Force on all taxels under pressure together, against their normals, N; 0 without a complete calibration.
  [[nodiscard]] double force_n() const;

  /// Finds the modules with a taxel that reads TouchMap::kPressed_counts or more above rest, which no touch causes: a
  /// part that was exchanged or removed since the last tare has another rest value. Taxels of these modules that read
  /// equally far below rest count as well. The modules are in ascending order. Cost: O(modules).
  [[nodiscard]] design::OffRest off_rest() const;

  /// Closes a period of `seconds` (> 0): rates are those of the last closed period.
  void close_period(double seconds);
  /// Returns the samples per second and module of a patch in the last period; 0 when none arrived.
  [[nodiscard]] double rate_hz(layout::PatchIndex patch) const;
  /// Counts the modules of a patch whose latest sample reports a fault.
  [[nodiscard]] int faults(layout::PatchIndex patch) const;
  /// Counts the modules of a patch that never sent a sample.
  [[nodiscard]] int unheard(layout::PatchIndex patch) const;
  /// Draws the patch in its shape, with the highest row first. Each module has a cell, which points up or down as the
  /// module does and shows the largest pressure of its taxels, or its fault. `colour` uses the colours of a terminal;
  /// `columns` is the width of the picture in characters (0: no limit). If a patch lies on several islands, they are
  /// drawn side by side as far as the width permits, each under its name. If an island is too wide, its cells first
  /// lose the space between them and then shrink to one character: tenths of the range, 0 … 9, ! for a fault. What is
  /// still too wide is cut at the right and ends in "…".
  [[nodiscard]] std::vector<std::string> picture(layout::PatchIndex patch, PressureUnit unit, bool colour,
                                                 int columns = 0) const;

 private:
  struct Module {
    wire::ModuleState state = wire::ModuleState::kUnknown;
    bool heard = false;
    std::uint64_t samples = 0;  // Only samples of the present period count.
    double rate_hz = 0.0;       // The rate belongs to the last period.
  };
  [[nodiscard]] const std::vector<design::RoutedModule>& modules_of(layout::PatchIndex patch) const;
  enum class CellForm { kSpaced, kClose, kDigit };
  // The outer key is the row, the inner key the column, and the value the module.
  using Rows = std::map<int, std::map<int, layout::ModuleId>, std::greater<>>;
  [[nodiscard]] std::string cell(layout::ModuleId module, PressureUnit unit, bool colour, CellForm form) const;
  [[nodiscard]] std::vector<std::string> island_picture(const Rows& rows, PressureUnit unit, bool colour,
                                                        std::size_t columns) const;

  const design::Design& design_;
  TouchMap touches_;
  design::SkinCalibration calibration_;
  std::vector<Module> modules_;
};

}  // namespace triskin::skin
