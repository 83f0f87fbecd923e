// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace triskin::sim {

/// One I²C line as its master sees it, byte by byte (UM10204). Implemented by the virtual hardware (host/sim),
/// driven by board/posix and by the modelled machine. `now_us` is virtual time at the end of the operation and
/// never decreases. A line that is stuck answers no start; `scl`/`sda` give the levels.
class I2cBus {
 public:
  virtual ~I2cBus() = default;
  /// Start or repeated start with the address byte (7-bit address << 1 | read). True: acknowledged.
  virtual bool start(std::uint8_t address_byte, std::uint64_t now_us) = 0;
  /// Writes one byte. True: acknowledged.
  virtual bool write(std::uint8_t byte, std::uint64_t now_us) = 0;
  /// Reads one byte; `acknowledge` is what the master answers. 0xFF when nobody drives the line.
  virtual std::uint8_t read(bool acknowledge, std::uint64_t now_us) = 0;
  /// Stop condition: the transfer ends.
  virtual void stop(std::uint64_t now_us) = 0;
  /// True when SCL is high.
  /// Levels with the master's drivers released.
  [[nodiscard]] virtual bool scl() const = 0;
  /// True when SDA is high.
  [[nodiscard]] virtual bool sda() const = 0;
  /// The controller's own weak pull-ups are on or off: a line without others floats without them.
  virtual void controller_pulls_up(bool) {}
  /// One SCL pulse of the bus-clear procedure (UM10204 §3.1.16).
  virtual void pulse_scl(std::uint64_t now_us) = 0;
};

}  // namespace triskin::sim
