// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "triskin/session/bus.hpp"
#include "triskin/wire/log.hpp"

namespace triskin::session {

struct LogEntry {
  std::uint8_t node = 0;
  wire::LogLevel level = wire::LogLevel::kInformation;
  double time_s = 0.0;  ///< The time starts when the controller starts.
  std::string text;
};

/// Reads the logs of controllers, starting with the oldest lines that they still have. While the reader exists, it
/// receives all frames of the bus that are not answers. Use it in the thread of the bus.
class LogReader {
 public:
  using OnLine = std::function<void(const LogEntry&)>;
  /// Asks the controllers at `nodes` for lines up to `level`. `bus` must outlive the reader. Throws Refused when a
  /// firmware has no log, and the exceptions of every request.
  LogReader(Bus& bus, std::vector<std::uint8_t> nodes, wire::LogLevel level, OnLine on_line);
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;
  /// Ends the logs as finish() does, but ignores controllers that do not answer.
  ~LogReader();
  /// Passes lines on until `until_us` of the bus. Throws Unreachable, Cancelled.
  void run_until(std::uint64_t until_us);
  /// Asks the controllers to stop sending lines. Throws as every request does.
  void finish();
  /// Counts the lines that were overwritten or lost during transmission.
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

}  // namespace triskin::session
