// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/cli/calibration_options.hpp"
#include "triskin/skin/live_skin.hpp"

namespace triskin::cli {

/// `live` for the covers of a robot: a line for each cover that is touched, with --json an object a bus, every 0.2 s;
/// at the end the account of every cover. Returns the exit status. Throws as device::LiveBus does.
int live_robot(device::LiveSkin& skin, const device::StreamOptions& options, const CalibrationOptions& calibration,
               double seconds, Output& output);

}  // namespace triskin::cli
