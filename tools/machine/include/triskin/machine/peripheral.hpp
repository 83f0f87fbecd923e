// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "triskin/machine/scheduler.hpp"

namespace triskin::machine {

/// An access that the silicon refuses, or after which its behaviour is undefined.
struct Violation {
  std::uint64_t at_us = 0;
  std::string what;
};

/// Interface through which a peripheral model acts on the machine: time, interrupts, resets, violations.
class Surroundings {
 public:
  virtual ~Surroundings() = default;
  /// Virtual time, and what is booked for later.
  virtual Scheduler& time() = 0;
  /// Level of an interrupt line of the NVIC.
  virtual void set_irq(int irq, bool level) = 0;
  /// Records what the silicon would have refused, with the present time and code address. The run goes on.
  virtual void violation(std::string what) = 0;
  /// Clock of the core and the buses at present, Hz.
  [[nodiscard]] virtual std::uint64_t sysclk_hz() const = 0;
  /// System reset; `cause` is the flag in RCC_CSR.
  virtual void request_reset(std::uint32_t cause) = 0;
  /// Non-maskable interrupt, as the flash raises it for a unit with two wrong bits.
  virtual void raise_nmi() = 0;
};

/// A block of registers. Offsets are from its base; sizes 1, 2, 4 bytes.
class Peripheral {
 public:
  /// `around` must outlive the block. Registers have no value before reset().
  explicit Peripheral(Surroundings& around) : around_(around) {}
  virtual ~Peripheral() = default;
  Peripheral(const Peripheral&) = delete;
  Peripheral& operator=(const Peripheral&) = delete;
  /// Value of the register at `offset` bytes from the base, with the side effects that reading has there; `size` in
  /// bytes. A register that is not there reads 0.
  virtual std::uint32_t read(std::uint32_t offset, unsigned size) = 0;
  /// Writes the low `size` bytes of `value` to the register at `offset` bytes from the base. What the manual forbids is
  /// a violation.
  virtual void write(std::uint32_t offset, std::uint32_t value, unsigned size) = 0;
  /// Gives every register its reset value, as after power-up or a system reset.
  virtual void reset() = 0;

 protected:
  Surroundings& around_;
};

}  // namespace triskin::machine
