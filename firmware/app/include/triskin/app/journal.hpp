// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/app/identifiers.hpp"
#include "triskin/logic/diagnostics/log.hpp"

namespace triskin::fw {

/// Logs what a person at the bench wants to know: how the controller started, its table, modules and lines that fail or
/// recover, a bus-off. It observes the state from outside, so no part of the sampling knows the log.
class Journal {
 public:
  /// Everything that `parts` refers to, and `log`, must outlive the journal.
  Journal(Log& log, const PatchParts& parts) : log_(log), parts_(parts) {}
  /// Logs version, clock, findings and crash once after the start. Cost: a few lines.
  void started();
  /// Logs the active table after each start of the sampling.
  void table();
  /// Logs the changes since the last call; called once per sequence.
  void look();
  /// Logs that a host asked for a stream, or for a restart.
  void stream(wire::StreamMode mode);
  void restart();

 private:
  void look_at_modules();
  void look_at_lines();
  void look_at_bus();
  void crash();
  [[nodiscard]] std::uint64_t now_us() const { return parts_.ports.clock->now_us(); }

  Log& log_;
  PatchParts parts_;
  std::array<wire::ModuleState, layout::kMaxModules> states_{};
  std::array<bool, layout::kLines> stuck_{};
  std::uint32_t bus_offs_ = 0;
  std::uint8_t looks_ = 0;
};

}  // namespace triskin::fw
