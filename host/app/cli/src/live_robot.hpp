// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "calibration_options.hpp"
#include "triskin/skin/live_skin.hpp"

namespace triskin::cli {

/// Implements `live` for the covers of a robot: every 0.2 s it prints a line for each touched cover, or with --json an
/// object for each bus, and finally the account of every cover. Returns the exit status. Throws as skin::LiveBus
/// does.
int live_robot(skin::LiveSkin& skin, const session::StreamOptions& options, const CalibrationOptions& calibration,
               double seconds, Output& output);

}  // namespace triskin::cli
