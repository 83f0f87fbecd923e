// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "triskin/machine/scheduler.hpp"

namespace triskin::machine {

/// Records bus signals and CPU state as a value change dump (clause 18 of IEEE 1364-2005) for a wave viewer, at 1 ns.
class VcdTrace {
 public:
  /// Records one byte with its acknowledge bit on line 0..3, which ended at `end`; `period` is that of SCL.
  void i2c_byte(int line, std::uint8_t byte, bool acknowledged, Time end, Time period);
  /// Records a start or repeated start on line 0..3 at `at` ps.
  void i2c_start(int line, Time at);
  /// Records a stop on line 0..3 at `at` ps: SCL rises, then SDA.
  void i2c_stop(int line, Time at);
  /// Records that the controller sends a CAN frame (true) or has ended it, at `at` ps.
  void can_busy(bool busy, Time at) { change(kCan, busy ? 1 : 0, at); }
  /// Records the number of the exception that runs from `at` ps on (ARMv7-M: 16 + interrupt); 0 means none.
  void exception(int number, Time at) { change(kException, static_cast<std::uint32_t>(number), at); }
  /// Records that the core sleeps in WFI (true) or has woken, at `at` ps.
  void sleeping(bool asleep, Time at) { change(kSleep, asleep ? 1 : 0, at); }
  /// Writes text() to a file; a failure leaves no partial file. Throws InputError naming the file when it cannot be
  /// written.
  void write(const std::filesystem::path& path) const;
  /// Returns the whole dump; changes are sorted by time. Cost: one line per change.
  [[nodiscard]] std::string text() const;

 private:
  static constexpr int kScl = 0, kSda = 4, kCan = 8, kException = 9, kSleep = 10, kSignals = 11;
  struct Change {
    Time at;
    int signal;
    std::uint32_t value;
  };
  void change(int signal, std::uint32_t value, Time at) { changes_.push_back({at, signal, value}); }
  std::vector<Change> changes_;
};

}  // namespace triskin::machine
