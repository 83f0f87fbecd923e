// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "triskin/design/calibration.hpp"
#include "triskin/skin/skin_contacts.hpp"
#include "triskin/skin/touch_map.hpp"
#include "triskin/wire/module_state.hpp"

namespace triskin::device {

/// Unit of the numbers in a picture of a patch.
enum class PressureUnit {
  kCounts,   ///< The unit is the converter's count.
  kPercent,  ///< The unit is a percentage of the counts between rest and the end of the range.
  kKpa,      ///< The calibration gives kPa, and 0 where there is none.
};

/// What is known of a skin while its samples come: pressure, states, rates; and its picture as text. Not thread-safe.
class LiveMonitor {
 public:
  /// `design` outlives the monitor. `rest` as for TouchMap.
  explicit LiveMonitor(const design::Design& design, const design::RestValues& rest = {},
                       design::SkinCalibration calibration = {});
  /// Takes a sample.
  void add(const ModuleSample& frame);
  [[nodiscard]] TouchMap& touches() { return touches_; }
  [[nodiscard]] const TouchMap& touches() const { return touches_; }
  /// Gives counts a value from now on.
  void set_calibration(design::SkinCalibration calibration) { calibration_ = std::move(calibration); }
  /// What the counts are worth.
  [[nodiscard]] const design::SkinCalibration& calibration() const { return calibration_; }
  /// What presses the skin now, the strongest first (skin_contacts.hpp). Cost: some ms for each contact.
  [[nodiscard]] std::vector<SkinContact> contacts() const;
  /// Force on all taxels under pressure together, against their normals, N; 0 without a complete calibration.
  [[nodiscard]] double force_n() const;

  /// Closes a period of `seconds` (> 0): rates are those of the last closed period.
  void close_period(double seconds);
  /// Samples a second of a patch and module, in the last period; 0 when nothing came.
  [[nodiscard]] double rate_hz(int patch) const;
  /// Modules of a patch whose latest sample says that something is wrong.
  [[nodiscard]] int faults(int patch) const;
  /// Modules of a patch that never sent a sample.
  [[nodiscard]] int unheard(int patch) const;
  /// The patch in its shape, the highest row first: a cell a module, which points up or down as the module does, with
  /// the largest pressure of its taxels, or what is wrong. `colour`: with the colours of a terminal. `columns`: width
  /// of the picture in characters (0: any). Where a patch lies on several islands, they stand side by side as the width
  /// permits, each under its name. Where an island is wider than that, cells first lose the space between them and then
  /// have one character: tenths of the range, 0 … 9, ! for a fault; what is still wider is cut at the right and ends
  /// in "…".
  [[nodiscard]] std::vector<std::string> picture(int patch, PressureUnit unit, bool colour, int columns = 0) const;

 private:
  struct Module {
    wire::ModuleState state = wire::ModuleState::kUnknown;
    bool heard = false;
    std::uint64_t samples = 0;  // Samples of this period.
    double rate_hz = 0.0;       // Rate in the last period.
  };
  [[nodiscard]] const std::vector<design::RoutedModule>& modules_of(int patch) const;
  enum class CellForm { kSpaced, kClose, kDigit };
  using Rows = std::map<int, std::map<int, int>, std::greater<>>;  // Keyed by row, then by column: module.
  [[nodiscard]] std::string cell(int module, PressureUnit unit, bool colour, CellForm form) const;
  [[nodiscard]] std::vector<std::string> island_picture(const Rows& rows, PressureUnit unit, bool colour,
                                                        std::size_t columns) const;

  const design::Design& design_;
  TouchMap touches_;
  design::SkinCalibration calibration_;
  std::vector<Module> modules_;
};

}  // namespace triskin::device
