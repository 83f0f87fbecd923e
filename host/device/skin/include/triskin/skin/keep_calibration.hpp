// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "triskin/skin/live_skin.hpp"

/// Stores calibrations of a skin in its controllers and on this computer (docs/calibration.md).
namespace triskin::skin {

/// The calibration is stored on this computer.
struct KeptCalibration {
  design::BoardCalibration board;
  /// False means that the controller could not store it, because of older firmware or another table.
  bool in_controller = false;
};

/// Stores a new calibration of a cover of `bus`, both in the controllers and on this computer, with the rest values
/// that belong to it. Boards get their revision and date; their modules that were not measured keep the calibration
/// that they have. Interrupts wait. Throws Unreachable, and InputError when a file cannot be
/// written.
[[nodiscard]] std::vector<KeptCalibration> keep_calibration(LiveBus& bus, LiveCover& cover, CalibrationOutcome outcome);

/// Stores those calibrations of a file whose controllers answer on `bus` and serve the cover, unchanged. The result is
/// empty if there are none. Throws as keep_calibration, and InputError for a file that cannot be read.
[[nodiscard]] std::vector<KeptCalibration> keep_calibration_file(LiveBus& bus, const LiveCover& cover,
                                                                 const std::filesystem::path& file);

/// Deletes the calibrations of the controllers that serve the cover, in the controllers and on this computer. Returns
/// the serial numbers of those that had one. Throws Unreachable.
[[nodiscard]] std::vector<std::string> forget_calibration(LiveBus& bus, const LiveCover& cover);

}  // namespace triskin::skin
