// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "triskin/machine/map.hpp"
#include "triskin/machine/peripheral.hpp"

namespace triskin::machine {

/// Models the system control space of the Cortex-M4 (ARMv7-M ARM, B3): NVIC, SysTick, and the part of the SCB that
/// firmware uses. It decides which exception is next; the core enters and leaves it.
class Nvic final : public Peripheral {
 public:
  static constexpr int kExceptions = 16 + map::kInterrupts, kNmi = 2, kHardFault = 3, kPendSv = 14, kSysTick = 15;
  static constexpr int kIdlePriority = 256;

  explicit Nvic(Surroundings& around) : Peripheral(around) { reset(); }
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;

  void set_level(int irq, bool level);
  void pend(int exception) { pending_[at(exception)] = true; }
  /// Returns the pending, enabled exception with the lowest priority number; 0 if there is none.
  [[nodiscard]] int next() const;
  [[nodiscard]] int priority(int exception) const;
  /// Returns the priority of the running code, ignoring masks; kIdlePriority in thread mode.
  [[nodiscard]] int running_priority() const;
  [[nodiscard]] int running() const { return active_.empty() ? 0 : active_.back(); }
  void enter(int exception);
  void leave();

  [[nodiscard]] std::uint32_t vtor() const { return vtor_; }
  /// Returns the vectors in flash to which VTOR last pointed; the image may have copied them to RAM since.
  [[nodiscard]] std::uint32_t image() const { return image_; }
  [[nodiscard]] bool fpu_on() const { return (cpacr_ >> 20 & 0xF) == 0xF; }
  /// Sets the fault status as the processor leaves it for the handler of the hard fault: bits of CFSR, and the address
  /// of a precise access.
  void note_fault(std::uint32_t status, std::uint32_t address) {
    cfsr_ |= status;
    hfsr_ |= 1U << 30;  // The FORCED bit is set because the configurable handlers are off.
    if (address != 0) bfar_ = address;
  }
  /// True after a change that the core must handle.
  bool poked = false;

 private:
  static std::size_t at(int exception) { return static_cast<std::size_t>(exception); }
  void write_bits(std::uint32_t offset, std::uint32_t value);
  void write_control(std::uint32_t offset, std::uint32_t value);
  void book_tick();
  [[nodiscard]] Time tick_period() const;

  std::array<bool, kExceptions> pending_{}, enabled_{}, level_{}, is_active_{};
  std::array<std::uint8_t, kExceptions> priority_{};
  std::vector<int> active_;
  std::uint32_t vtor_ = 0, image_ = 0, cpacr_ = 0, cfsr_ = 0, hfsr_ = 0, bfar_ = 0, tick_control_ = 0, tick_reload_ = 0;
  Time tick_base_ = 0;
  std::uint64_t tick_generation_ = 0;
};

}  // namespace triskin::machine
