// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/host/progress.hpp"
#include "triskin/jobs/finding_kind.hpp"
#include "triskin/session/bus.hpp"

namespace triskin::device {

/// One thing that does not match the design.
struct Finding {
  FindingKind kind = FindingKind::kAbsentController;
  int module = -1;  ///< -1: concerns a controller or a line
  int patch = -1;
  int other = -1;  ///< the module that answered instead, where there is one
  int line = -1;   ///< where it was found, or the line itself
  int address = -1;
  int taxel = -1;
  std::string text;
  std::string remedy;
};

struct VerifyOptions {
  bool touch =
      false;  ///< press every module in turn: by the finger of a simulated link, else by the person who is asked
  /// Asks a person to press a module and to say when; false: skip this module. Needed for touch on real links.
  std::function<bool(int module)> ask;
  double watch_s = 2.0;  ///< least time over which faults that come and go are collected
};

struct VerifyResult {
  int modules_ok = 0;
  int modules = 0;
  int touched = 0;  ///< modules that were pressed
  std::vector<Finding> findings;
  /// What the controllers remember from before, and is not there now (kLostConfiguration, kIntermittentModule).
  /// It was deleted from their memories, so that what comes again is found again.
  std::vector<Finding> earlier;
};

/// Asks the hardware whether it is the design. Throws DeviceError when nothing answers at all or a controller is lost
/// on the way.
VerifyResult verify(Bus& bus, const design::Design& design, const VerifyOptions& options,
                    const ProgressSink& progress = {});

}  // namespace triskin::device
