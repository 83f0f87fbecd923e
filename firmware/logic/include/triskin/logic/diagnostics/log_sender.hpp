// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/logic/diagnostics/log.hpp"
#include "triskin/ports/ports.hpp"

namespace triskin::fw {

/// Sends the log to one host over a CAN port, at most one frame per millisecond, so that samples and answers continue.
class LogSender {
 public:
  /// Sends lines up to `level` to the host, from the oldest one on, in frames of at most `frame_bytes`; kOff ends it.
  void set(wire::LogLevel level, std::uint8_t frame_bytes);
  [[nodiscard]] wire::LogLevel level() const { return reader_.level; }
  /// Returns when step() has a frame to send; UINT64_MAX means that the host has all lines.
  [[nodiscard]] std::uint64_t next_us(const Log& log) const;
  /// Sends the next frame when it is due. `node` is the address of this controller.
  void step(const Log& log, CanPort& port, std::uint8_t node, std::uint64_t now_us);

 private:
  Log::Reader reader_{};
  std::uint32_t begun_at_ = 0;  // A part of this line has been sent.
  std::uint64_t next_us_ = 0;
  std::uint8_t frame_bytes_ = 8;
  wire::LogEncoder encoder_;
};

/// Writes the log as text to a serial port: "    12.345 warning: module 5 absent". It never waits for the port.
class SerialLog {
 public:
  explicit SerialLog(SerialPort* port) : port_(port) {}
  /// Returns true while bytes wait for room; call step() again within a millisecond.
  [[nodiscard]] bool waits(const Log& log) const;
  void step(const Log& log);

 private:
  void begin(const wire::LogLine& line);
  SerialPort* port_;
  Log::Reader reader_{kCompiledLogLevel, 0};
  std::array<char, wire::kMaxLogText + 32> text_{};
  std::size_t size_ = 0, at_ = 0;
};

}  // namespace triskin::fw
