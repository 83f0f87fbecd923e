// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/rest_values.hpp"
#include "triskin/diagnose/finding_kind.hpp"
#include "triskin/link/touch_actuator.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/stream_report.hpp"

namespace triskin::device {

/// One thing that does not match the design.
struct Finding {
  FindingKind kind = FindingKind::kAbsentController;
  int module = -1;  ///< It is −1 if the finding concerns a controller or a line.
  int patch = -1;
  int other = -1;  ///< It is the module that answered instead, where there is one.
  int line = -1;   ///< It is the line where the module was found, or the line itself.
  int address = -1;
  int taxel = -1;
  std::vector<int> behind{};      ///< further modules that this one cause concerns, ascending
  std::uint64_t held_design = 0;  ///< kWrongTable: the other design whose tables the controllers hold; 0: none
  std::string held_file{};        ///< a file of that design, where one is known (files_of_design())
  /// Where the module lies on the cover ("island 0, row 3 of 9, left rim"), or where the cable of the patch enters;
  /// empty: neither is known.
  std::string place;
  std::string text;
  std::string remedy;
};

struct VerifyOptions {
  /// Press every module in turn: by `actuator`, otherwise by the person who is asked.
  bool touch = false;
  /// Presses modules of the design; null: `ask` has a person do it.
  TouchActuator* actuator = nullptr;
  /// Asks a person to press a module and to say when; false: skip this module. Needed for touch without an actuator.
  std::function<bool(int module)> ask;
  std::vector<StreamDemand> neighbours;  ///< They are passed on as StreamOptions::neighbours.
  design::RestValues rest;               ///< where every taxel rests, as kept on this computer; empty: not known
  /// Image of the firmware with debug information: names function and line of a crash; empty: addresses only.
  std::filesystem::path elf;
  double watch_s = 2.0;  ///< Intermittent faults are collected for at least so long, in s, ≥ 0.
};

struct VerifyResult {
  int modules_ok = 0;
  int modules = 0;
  int touched = 0;  ///< So many modules were pressed.
  std::vector<Finding> findings;
  /// Faults that the controllers recorded earlier and that are gone now (kLostConfiguration, kIntermittentModule). They
  /// were deleted from their memories, so that what comes again is found again.
  std::vector<Finding> earlier;
  /// What came of the samples that were due in half a second at least; empty where the link carries no full stream, or
  /// a controller has no table or that of a failure.
  std::optional<StreamReport> stream;
};

/// How far from its rest value a taxel may be that nobody touches, counts: from there on `live` shows it as pressed.
inline constexpr double kMaxRestError_counts = 200.0;

/// Compares the hardware with the design: controllers, tables, modules, taxels, joints. With `options.rest` also where
/// the taxels rest, so nobody may touch the skin at the end. Clears the fault memories of
/// the controllers. Takes watch_s at least, with touch 0.2 s a module on a simulated link. Progress has a part for each
/// patch. Throws DeviceError when no controller answers or one stops answering, InputError when the design does not fit
/// into tables, Cancelled when the process was asked to end.
VerifyResult verify(Bus& bus, const design::Design& design, const VerifyOptions& options,
                    const ProgressSink& progress = {});

}  // namespace triskin::device
