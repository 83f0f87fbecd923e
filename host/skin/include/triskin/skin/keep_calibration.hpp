// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "triskin/skin/live_skin.hpp"

/// Where calibrations of a skin are kept: in its controllers, and on this computer (docs/calibration_storage.md).
namespace triskin::device {

/// A calibration that this computer keeps.
struct KeptCalibration {
  design::BoardCalibration board;
  bool in_controller = false;  ///< its controller keeps it as well; false: that has an older firmware or another table
};

/// Keeps a new calibration of a cover of `bus`, in the controllers and here, and the rest values, which belong to it.
/// Boards get their revision and date. Throws Unreachable, InputError when a file cannot be written.
[[nodiscard]] std::vector<KeptCalibration> keep_calibration(LiveBus& bus, LiveCover& cover, CalibrationOutcome outcome);

/// Keeps the calibrations of a file whose controllers answer on `bus` and serve the cover, as they are; empty: there
/// are none. Throws as keep_calibration, and InputError for a file that cannot be read.
[[nodiscard]] std::vector<KeptCalibration> keep_calibration_file(LiveBus& bus, const LiveCover& cover,
                                                                 const std::filesystem::path& file);

/// Forgets the calibrations of the controllers that serve the cover, there and here; returns the serial numbers of
/// those that had one. Throws Unreachable.
[[nodiscard]] std::vector<std::string> forget_calibration(LiveBus& bus, const LiveCover& cover);

}  // namespace triskin::device
