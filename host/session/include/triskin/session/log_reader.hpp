// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "triskin/session/bus.hpp"
#include "triskin/wire/log.hpp"

namespace triskin::device {

/// A line of a controller's log.
struct LogEntry {
  std::uint8_t node = 0;
  wire::LogLevel level = wire::LogLevel::kInformation;
  double time_s = 0.0;  ///< since the controller started
  std::string text;
};

/// Reads the logs of controllers, from the oldest lines that they still have. While it lives it takes the frames that
/// are no answers from the bus. Threads: that of the bus.
class LogReader {
 public:
  using OnLine = std::function<void(const LogEntry&)>;
  /// Asks the controllers at `nodes` for lines up to `level`. `bus` outlives the reader. Throws Refused when a firmware
  /// has no log, and what every request throws.
  LogReader(Bus& bus, std::vector<std::uint8_t> nodes, wire::LogLevel level, OnLine on_line);
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;
  /// Ends the logs as finish() does, without a word when a controller does not answer.
  ~LogReader();
  /// Hands lines on until `until_us` of the bus. Throws Unreachable, Cancelled.
  void run_until(std::uint64_t until_us);
  /// Asks the controllers to send no more lines. Throws as every request does.
  void finish();
  /// Lines that were overwritten or lost on the way.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  struct Source {
    wire::LogDecoder decoder;
    int last_number = -1;
  };
  void take(const wire::CanFrame& frame);

  Bus& bus_;
  std::vector<std::uint8_t> nodes_;
  OnLine on_line_;
  bool all_levels_;
  std::map<std::uint8_t, Source> sources_;
  std::uint64_t lost_ = 0;
  bool open_ = true;
};

}  // namespace triskin::device
