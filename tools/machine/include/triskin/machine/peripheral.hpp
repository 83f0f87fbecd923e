// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "triskin/machine/scheduler.hpp"

namespace triskin::machine {

/// Describes an access that the silicon refuses, or after which its behaviour is undefined.
struct Violation {
  std::uint64_t at_us = 0;
  std::string what;
};

/// Lets a peripheral model act on the machine: time, interrupts, resets, violations.
class Surroundings {
 public:
  virtual ~Surroundings() = default;
  /// Returns virtual time and the events booked for later.
  virtual Scheduler& time() = 0;
  /// Sets the level of an interrupt line of the NVIC.
  virtual void set_irq(int irq, bool level) = 0;
  /// Records an action that the silicon would have refused, with the present time and code address. The run continues.
  virtual void violation(std::string what) = 0;
  /// Returns the present clock of the core and the buses, Hz.
  [[nodiscard]] virtual std::uint64_t sysclk_hz() const = 0;
  /// Requests a system reset; `cause` is the flag in RCC_CSR.
  virtual void request_reset(std::uint32_t cause) = 0;
  /// Returns false while the core executes nothing from the flash: a debugger holds it, or the ROM's loader runs.
  [[nodiscard]] virtual bool core_runs() const { return true; }
  /// Raises a non-maskable interrupt, as the flash does for a unit with two wrong bits.
  virtual void raise_nmi() = 0;
};

/// Models a block of registers. Offsets count from its base; sizes are 1, 2 or 4 bytes.
class Peripheral {
 public:
  /// `around` must outlive the block. Registers have no value before reset().
  explicit Peripheral(Surroundings& around) : around_(around) {}
  virtual ~Peripheral() = default;
  Peripheral(const Peripheral&) = delete;
  Peripheral& operator=(const Peripheral&) = delete;
  /// Returns the value of the register at `offset` bytes from the base, with the side effects of reading; `size` is in
  /// bytes. A register that does not exist reads 0.
  virtual std::uint32_t read(std::uint32_t offset, unsigned size) = 0;
  /// Writes the low `size` bytes of `value` to the register at `offset` bytes from the base. A write that the manual
  /// forbids is a violation.
  virtual void write(std::uint32_t offset, std::uint32_t value, unsigned size) = 0;
  /// Gives every register its reset value, as after power-up or a system reset.
  virtual void reset() = 0;

 protected:
  Surroundings& around_;
};

}  // namespace triskin::machine
