// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "triskin/wire/log.hpp"

#ifndef TRISKIN_LOG_LEVEL
#define TRISKIN_LOG_LEVEL 3
#endif

namespace triskin::fw {

/// Lines of later levels are not compiled into the image (CMake's TRISKIN_LOG_LEVEL, 0 … 4).
inline constexpr auto kCompiledLogLevel = static_cast<wire::LogLevel>(TRISKIN_LOG_LEVEL);
static_assert(kCompiledLogLevel <= wire::LogLevel::kDebug);

/// Writes the text of one line; text without room is left out.
class LogText {
 public:
  explicit LogText(wire::LogLine& line) : line_(line) {}
  LogText& text(std::string_view text);
  LogText& decimal(std::uint32_t value);
  /// Writes an address in the image as `@0800abcd`, which a host turns into function and line.
  LogText& address(std::uint32_t value);

 private:
  wire::LogLine& line_;
};

/// The log keeps the last lines of a controller for several readers. Only the main loop writes lines, and not while it
/// waits for its flash, because the formatting code is neither in RAM nor within the time limit of an interrupt.
class Log {
 public:
  static constexpr std::uint32_t kLines = 16;

  /// A reader knows its next line. A new one begins with the oldest line.
  struct Reader {
    wire::LogLevel level = wire::LogLevel::kOff;
    std::uint32_t at = 0;
  };

  /// `fill(LogText&)` writes the line. It is neither called nor in the image when the level is not compiled in.
  template <wire::LogLevel kLevel, class Fill>
  void add(std::uint64_t now_us, Fill&& fill) {
    if constexpr (kLevel <= kCompiledLogLevel) {
      wire::LogLine& line = begin(kLevel, now_us);
      LogText text(line);
      std::forward<Fill>(fill)(text);
      ++count_;
    }
  }
  /// Returns the reader's next line, valid until a line is added, or null if it has read all lines of its levels.
  /// Overwritten lines are skipped.
  [[nodiscard]] const wire::LogLine* next(Reader& reader) const;

 private:
  wire::LogLine& begin(wire::LogLevel level, std::uint64_t now_us);
  std::array<wire::LogLine, kLines> lines_{};
  std::uint32_t count_ = 0;  // Lines are counted from the start.
};

}  // namespace triskin::fw
