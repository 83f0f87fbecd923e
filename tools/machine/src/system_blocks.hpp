// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>

#include "map.hpp"
#include "triskin/machine/peripheral.hpp"

namespace triskin::machine {

/// Reset and clock control with power control's boost bit (RM0440 §7.4, §6.4). Oscillators need their start-up times.
class Rcc final : public Peripheral {
 public:
  Rcc(Surroundings& around, bool crystal_works) : Peripheral(around), crystal_works_(crystal_works) { reset(); }
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;
  [[nodiscard]] std::uint64_t sysclk_hz() const { return sysclk_hz_; }
  /// Is the clock of a peripheral on? `offset` of its enable register.
  [[nodiscard]] bool enabled(std::uint32_t offset, unsigned bit) const { return (regs_[offset / 4] >> bit & 1) != 0; }
  /// HSI48 runs and is what USB gets (CRRCR, CCIPR.CLK48SEL).
  [[nodiscard]] bool clock_48_ready() const { return (regs_[0x98 / 4] & 2) != 0 && (regs_[0x88 / 4] >> 26 & 3) == 0; }
  void note_reset(std::uint32_t cause) { csr_flags_ |= cause; }
  void set_wait_states(std::uint32_t states) { wait_states_ = states; }
  void set_boost(bool boost) { boost_ = boost; }

 private:
  void switch_clock();
  void write_control(std::uint32_t value);
  std::array<std::uint32_t, 64> regs_{};
  bool crystal_works_;
  bool boost_ = false;
  std::uint32_t wait_states_ = 0, csr_flags_ = 3U << 26;  // brown-out and pin, at power-up
  std::uint64_t sysclk_hz_ = 16'000'000, generation_ = 0;
};

/// PWR_CR5.R1MODE and storage for the rest.
class Pwr final : public Peripheral {
 public:
  Pwr(Surroundings& around, Rcc& rcc) : Peripheral(around), rcc_(rcc) { reset(); }
  std::uint32_t read(std::uint32_t offset, unsigned) override { return regs_[offset / 4 & 63]; }
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;

 private:
  Rcc& rcc_;
  std::array<std::uint32_t, 64> regs_{};
};

/// TIM2 as a free-running counter with one compare interrupt (§29.4).
class Tim2 final : public Peripheral {
 public:
  explicit Tim2(Surroundings& around) : Peripheral(around) { reset(); }
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;

 private:
  [[nodiscard]] std::uint64_t count() const;
  void book_compare();
  void update_irq() { around_.set_irq(map::kTim2Irq, (status_ & interrupts_) != 0); }
  std::uint32_t control_ = 0, interrupts_ = 0, status_ = 0, prescaler_ = 0, prescaler_next_ = 0, compare_ = 0;
  Time base_ = 0;
  std::uint64_t generation_ = 0;
};

/// Independent watchdog (§42.4): 32 kHz; once started only a reset stops it.
class Iwdg final : public Peripheral {
 public:
  explicit Iwdg(Surroundings& around) : Peripheral(around) { reset(); }
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;

 private:
  void reload();
  bool running_ = false, unlocked_ = false;
  std::uint32_t prescaler_ = 0, reload_ = 0xFFF;
  std::uint64_t generation_ = 0;
};

}  // namespace triskin::machine
