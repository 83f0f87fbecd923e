// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/base/progress.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/rest_values.hpp"
#include "triskin/diagnose/finding_kind.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/layout/taxel_signal.hpp"
#include "triskin/link/touch_actuator.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/stream_report.hpp"

namespace triskin::diagnose {

/// Each finding is a single difference between hardware and design.
struct Finding {
  FindingKind kind = FindingKind::kAbsentController;
  /// −1 means that the finding concerns a controller or a line.
  layout::ModuleId module = layout::ModuleId::none();
  layout::PatchIndex patch = layout::PatchIndex::none();
  layout::ModuleId other = layout::ModuleId::none();  ///< This other module answered instead; −1 means that none did.
  int line = -1;  ///< The module was found on this line, or the finding concerns the line itself.
  int address = -1;
  layout::TaxelIndex taxel = layout::TaxelIndex::none();
  std::vector<layout::ModuleId> behind{};  ///< The same cause concerns these further modules, in ascending order.
  std::uint64_t held_design = 0;  ///< With kWrongTable, the controllers have tables of this other design; 0 means none.
  std::string held_file{};        ///< If a file of that design is known (files_of_design()), its path is here.
  /// Place of the module on the cover ("island 0, row 3 of 9, left rim"), or of the entry of the patch's cable; empty
  /// if neither is known.
  std::string place;
  std::string text;
  std::string remedy;
};

struct VerifyOptions {
  /// Every module is pressed in turn, by `actuator` or by the person who is asked.
  bool touch = false;
  /// Presses modules of the design; if it is null, `ask` has a person do it.
  link::TouchActuator* actuator = nullptr;
  /// Asks a person to press a module and to confirm it; false skips the module. Required for touch without an actuator.
  std::function<bool(layout::ModuleId module)> ask;
  std::vector<session::StreamDemand> neighbours;  ///< The list is passed on as StreamOptions::neighbours.
  design::RestValues rest;  ///< These rest values are stored on this computer; empty means that they are not known.
  /// The firmware image with debug information names function and line of a crash; without it only addresses are given.
  std::filesystem::path elf;
  double watch_s = 2.0;  ///< Intermittent faults are collected for at least this long, in s, ≥ 0.
};

struct VerifyResult {
  int modules_ok = 0;
  int modules = 0;
  int touched = 0;  ///< This many modules were pressed.
  std::vector<Finding> findings;
  /// Faults that the controllers recorded earlier and that are gone now (kLostConfiguration, kIntermittentModule). They
  /// were deleted from the fault memories, so that a repeated fault is found again.
  std::vector<Finding> earlier;
  /// The account covers the samples that were due over at least half a second. It is empty where the link carries no
  /// full stream, or a controller has no table or a backup table.
  std::optional<session::StreamReport> stream;
};

/// An untouched taxel may differ from its rest value by this many counts; beyond that, `live` shows it as pressed.
inline constexpr double kMaxRestError_counts = layout::kPressed_counts;

/// Compares the hardware with the design: controllers, tables, modules, taxels, joints. With `options.rest` it also
/// compares the rest values, so nobody may touch the skin at the end. It clears the fault memories of the controllers.
/// Takes at least watch_s, and with touch 0.2 s per module on a simulated link. Progress has a part for each patch.
/// Throws DeviceError when no controller answers or one stops answering, InputError when the design does not fit into
/// tables, Cancelled when the process was asked to end.
VerifyResult verify(session::Bus& bus, const design::Design& design, const VerifyOptions& options,
                    const ProgressSink& progress = {});

}  // namespace triskin::diagnose
