// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace triskin::sim {

/// The interface is one I²C line as its master sees it, byte by byte (UM10204). The virtual hardware
/// (host/sim/hardware) implements it; board/posix and the modelled machine drive it. `now_us` is the virtual time at
/// the end of an operation and never decreases. A stuck line answers no start; `scl` and `sda` give its levels.
class I2cBus {
 public:
  virtual ~I2cBus() = default;
  /// Sends a start or repeated start with the address byte (7-bit address << 1 | read). Returns true if it was
  /// acknowledged.
  virtual bool start(std::uint8_t address_byte, std::uint64_t now_us) = 0;
  /// Writes one byte. Returns true if it was acknowledged.
  virtual bool write(std::uint8_t byte, std::uint64_t now_us) = 0;
  /// Reads one byte and answers with `acknowledge`. Returns 0xFF when nobody drives the line.
  virtual std::uint8_t read(bool acknowledge, std::uint64_t now_us) = 0;
  /// Sends a stop condition, which ends the transfer.
  virtual void stop(std::uint64_t now_us) = 0;
  /// Returns true when SCL is high while the master releases it.
  [[nodiscard]] virtual bool scl() const = 0;
  /// Returns true when SDA is high while the master releases it.
  [[nodiscard]] virtual bool sda() const = 0;
  /// Switches the controller's own weak pull-ups on or off; a line without other pull-ups floats when they are off.
  virtual void controller_pulls_up(bool) {}
  /// Sends one SCL pulse of the bus-clear procedure (UM10204 §3.1.16).
  virtual void pulse_scl(std::uint64_t now_us) = 0;
};

}  // namespace triskin::sim
