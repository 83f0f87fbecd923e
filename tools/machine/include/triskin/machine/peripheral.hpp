// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "triskin/machine/scheduler.hpp"

namespace triskin::machine {

/// Something that the silicon would have refused or that leads to undefined behaviour there.
struct Violation {
  std::uint64_t at_us = 0;
  std::string what;
};

/// What every peripheral sees of the machine.
class Surroundings {
 public:
  virtual ~Surroundings() = default;
  virtual Scheduler& time() = 0;
  /// Level of an interrupt line of the NVIC.
  virtual void set_irq(int irq, bool level) = 0;
  virtual void violation(std::string what) = 0;
  [[nodiscard]] virtual std::uint64_t sysclk_hz() const = 0;
  /// System reset; `cause` is the flag in RCC_CSR.
  virtual void request_reset(std::uint32_t cause) = 0;
  virtual void raise_nmi() = 0;
};

/// A block of registers. Offsets are from its base; sizes 1, 2, 4 bytes.
class Peripheral {
 public:
  explicit Peripheral(Surroundings& around) : around_(around) {}
  virtual ~Peripheral() = default;
  Peripheral(const Peripheral&) = delete;
  Peripheral& operator=(const Peripheral&) = delete;
  virtual std::uint32_t read(std::uint32_t offset, unsigned size) = 0;
  virtual void write(std::uint32_t offset, std::uint32_t value, unsigned size) = 0;
  virtual void reset() = 0;

 protected:
  Surroundings& around_;
};

}  // namespace triskin::machine
