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

/// Most that the image can say: lines of later levels are not in it at all (CMake's TRISKIN_LOG_LEVEL, 0 … 4).
inline constexpr auto kCompiledLogLevel = static_cast<wire::LogLevel>(TRISKIN_LOG_LEVEL);
static_assert(kCompiledLogLevel <= wire::LogLevel::kDebug);

/// Writes the text of one line; what finds no room is left out.
class LogText {
 public:
  explicit LogText(wire::LogLine& line) : line_(line) {}
  LogText& text(std::string_view text);
  LogText& decimal(std::uint32_t value);
  /// An address in the image as `@0800abcd`, which a host turns into function and line.
  LogText& address(std::uint32_t value);

 private:
  wire::LogLine& line_;
};

/// The last lines of a controller, for several readers. Lines are written by the main loop alone, and not while it
/// waits for its flash: the formatting is neither in RAM nor in the bound of an interrupt.
class Log {
 public:
  static constexpr std::uint32_t kLines = 16;

  /// A reader, and the line that it reads next. A new one begins with the oldest line.
  struct Reader {
    wire::LogLevel level = wire::LogLevel::kOff;
    std::uint32_t at = 0;
  };

  /// `fill(LogText&)` writes the line. Not called, and not in the image, when the level is not compiled in.
  template <wire::LogLevel kLevel, class Fill>
  void add(std::uint64_t now_us, Fill&& fill) {
    if constexpr (kLevel <= kCompiledLogLevel) {
      wire::LogLine& line = begin(kLevel, now_us);
      LogText text(line);
      std::forward<Fill>(fill)(text);
      ++count_;
    }
  }
  /// The line that the reader gets next, valid until a line is added; null: it has had all of its levels. Passes over
  /// lines that were overwritten.
  [[nodiscard]] const wire::LogLine* next(Reader& reader) const;

 private:
  wire::LogLine& begin(wire::LogLevel level, std::uint64_t now_us);
  std::array<wire::LogLine, kLines> lines_{};
  std::uint32_t count_ = 0;  // Lines written since the start.
};

}  // namespace triskin::fw
