// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>

#include "triskin/machine/map.hpp"
#include "triskin/machine/map_l452.hpp"
#include "triskin/machine/peripheral.hpp"

namespace triskin::machine {

struct CrystalSetup {
  std::uint64_t hz = 8'000'000;  ///< Zero stands for a missing crystal, or one that does not start.
  Time fails_at = kNever;        ///< At this time after power-up it stops permanently.
  double internal_error = 0;     ///< HSI is faster by this share.
};

/// Models what reset and clock control of all chips have in common. Oscillators need their start-up times. A crystal
/// that stops also stops the core, unless clock security is on: then the core continues with the internal oscillator
/// and gets an NMI (RM0440 §7.2.10).
class ClockControl : public Peripheral {
 public:
  ClockControl(Surroundings& around, const CrystalSetup& crystal) : Peripheral(around), crystal_(crystal) {}
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  [[nodiscard]] std::uint64_t sysclk_hz() const { return sysclk_hz_; }
  /// Tells whether the clock of a peripheral is on; `offset` is that of its enable register.
  [[nodiscard]] bool enabled(std::uint32_t offset, unsigned bit) const { return (regs_[offset / 4] >> bit & 1) != 0; }
  /// Returns true if HSI48 runs and is connected to USB (CRRCR, CCIPR.CLK48SEL).
  [[nodiscard]] bool clock_48_ready() const { return (regs_[0x98 / 4] & 2) != 0 && (regs_[0x88 / 4] >> 26 & 3) == 0; }
  void note_reset(std::uint32_t cause) { csr_flags_ |= cause; }
  /// Returns the frequency of the crystal as it reaches the chip now; 0 if it is off, does not swing yet, or has
  /// stopped.
  [[nodiscard]] std::uint64_t crystal_hz() const;
  /// Returns true if the core has no clock: only the watchdog still runs.
  [[nodiscard]] bool stopped() const { return stopped_; }
  void set_wait_states(std::uint32_t states) { wait_states_ = states; }
  void set_boost(bool boost) { boost_ = boost; }

 protected:
  [[nodiscard]] std::uint64_t internal_hz() const;
  /// What the data sheet says about the PLL, and the bits of CR and PLLCFGR that say ready and divide.
  struct Pll {
    std::uint64_t min_input_hz, max_input_hz, min_vco_hz, max_vco_hz;
    const char* input;       ///< The limits of the input, as text.
    const char* oscillator;  ///< The limits of the oscillator, as text.
    std::uint32_t divider_mask;
  };
  /// Sets registers and clock to their values after a reset, with CR and the clock that the core then has.
  void reset_clocks(std::uint32_t control, std::uint64_t sysclk_hz);
  /// Checks the rules of the chip for a core clock of `hz`; `was_pll` tells that it came from the PLL before.
  virtual void check_clock(std::uint64_t hz, bool was_pll) = 0;
  [[nodiscard]] virtual const Pll& pll() const = 0;
  /// Switches the core to the internal oscillator that runs after a failure of the crystal.
  virtual void use_internal() = 0;
  /// Returns the frequency of the source 0 … 3 of CFGR.SW, or of the PLL's source; 0 if it is not ready.
  [[nodiscard]] virtual std::uint64_t source_hz(std::uint32_t source) const = 0;
  [[nodiscard]] virtual std::uint64_t pll_source_hz(std::uint32_t source) const = 0;
  /// Starts and stops the oscillators of CR beside crystal and PLL.
  virtual void write_oscillators(std::uint32_t) {}
  [[nodiscard]] std::uint32_t& reg(std::uint32_t offset) { return regs_[offset / 4 & 63]; }
  [[nodiscard]] std::uint32_t reg(std::uint32_t offset) const { return regs_[offset / 4 & 63]; }
  /// Sets bit `ready` of CR after the start-up time, or clears it, when bit `on` has changed.
  void start_oscillator(std::uint32_t before, unsigned on, unsigned ready, Time delay);
  void set_sysclk(std::uint64_t hz) { sysclk_hz_ = hz; }
  [[nodiscard]] bool boost() const { return boost_; }
  [[nodiscard]] std::uint32_t wait_states() const { return wait_states_; }

 private:
  void switch_clock();
  void write_control(std::uint32_t value);
  void start_pll(std::uint32_t before);
  void lose_crystal();
  std::array<std::uint32_t, 64> regs_{};
  CrystalSetup crystal_;
  bool boost_ = false, stopped_ = false;
  std::uint32_t wait_states_ = 0, csr_flags_ = 3U << 26;  // The flags of brown-out and pin are set at power-up.
  std::uint64_t sysclk_hz_ = 16'000'000, generation_ = 0;
};

/// Models reset and clock control of the STM32G474 with power control's boost bit (RM0440 §7.4, §6.4).
class Rcc final : public ClockControl {
 public:
  Rcc(Surroundings& around, const CrystalSetup& crystal) : ClockControl(around, crystal) { reset(); }
  void reset() override;

 private:
  void check_clock(std::uint64_t hz, bool was_pll) override;
  [[nodiscard]] const Pll& pll() const override;
  void use_internal() override;
  [[nodiscard]] std::uint64_t source_hz(std::uint32_t source) const override;
  [[nodiscard]] std::uint64_t pll_source_hz(std::uint32_t source) const override;
};

/// Models reset and clock control of the STM32L452 (RM0394, chapter on RCC): the core starts with MSI at 4 MHz; HSI has
/// to be switched on. Only the range of MSI after a reset and voltage range 1 are modelled.
class RccL4 final : public ClockControl {
 public:
  RccL4(Surroundings& around, const CrystalSetup& crystal) : ClockControl(around, crystal) { reset(); }
  void reset() override;

 private:
  void check_clock(std::uint64_t hz, bool was_pll) override;
  [[nodiscard]] const Pll& pll() const override;
  void use_internal() override;
  [[nodiscard]] std::uint64_t source_hz(std::uint32_t source) const override;
  [[nodiscard]] std::uint64_t pll_source_hz(std::uint32_t source) const override;
  void write_oscillators(std::uint32_t before) override;
};

/// Models PWR_CR5.R1MODE and PWR_CR2.USV, and stores the other registers.
class Pwr final : public Peripheral {
 public:
  Pwr(Surroundings& around, ClockControl& rcc) : Peripheral(around), rcc_(rcc) { reset(); }
  std::uint32_t read(std::uint32_t offset, unsigned) override { return regs_[offset / 4 & 63]; }
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;
  /// Returns true if an STM32L4 connects VDDUSB to the transceiver of USB.
  [[nodiscard]] bool usb_supply_valid() const { return (regs_[1] & map::l452::kUsbSupplyValid) != 0; }

 private:
  ClockControl& rcc_;
  std::array<std::uint32_t, 64> regs_{};
};

/// Models TIM16 as far as it measures the crystal: the count at each eighth edge of the crystal divided by 32 (RM0440
/// chapter 31).
class Tim16 final : public Peripheral {
 public:
  Tim16(Surroundings& around, const ClockControl& rcc) : Peripheral(around), rcc_(rcc) { reset(); }
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;

 private:
  void catch_up();
  [[nodiscard]] bool captures() const;
  const ClockControl& rcc_;
  std::array<std::uint32_t, 64> regs_{};
  Time started_ = 0;
  std::uint64_t captured_ = 0;  // Edges are counted from the start.
};

/// Models TIM2 as a free-running counter with two compare interrupts (RM0440 chapter 30).
class Tim2 final : public Peripheral {
 public:
  explicit Tim2(Surroundings& around) : Peripheral(around) { reset(); }
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;
  void stand(bool still);

 private:
  [[nodiscard]] std::uint64_t count() const;
  void book_compare();
  void book_compare(std::size_t channel);
  void update_irq() { around_.set_irq(map::kTim2Irq, (status_ & interrupts_) != 0); }
  std::uint32_t control_ = 0, interrupts_ = 0, status_ = 0, prescaler_ = 0, prescaler_next_ = 0;
  std::array<std::uint32_t, 2> compare_{};
  Time base_ = 0, still_since_ = kNever;
  std::uint64_t generation_ = 0;
};

/// Models the debug unit as far as it stops TIM2 and the watchdog while a debugger holds the core. Only power-up resets
/// it.
class DebugUnit final : public Peripheral {
 public:
  explicit DebugUnit(Surroundings& around) : Peripheral(around) {}
  std::uint32_t read(std::uint32_t offset, unsigned) override { return offset == kApb1Freeze ? freeze_ : 0; }
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override { freeze_ = 0; }
  [[nodiscard]] bool timer_stands() const { return (freeze_ & 1) != 0; }
  [[nodiscard]] bool watchdog_stands() const { return (freeze_ >> 12 & 1) != 0; }

 private:
  static constexpr std::uint32_t kApb1Freeze = 8;
  std::uint32_t freeze_ = 0;
};

/// Models the independent watchdog (RM0440 §35.4): 32 kHz; once started, only a reset stops it. It can stand still.
class Iwdg final : public Peripheral {
 public:
  /// The oscillator is faster than 32 kHz by a share of `error`.
  explicit Iwdg(Surroundings& around, double error = 0) : Peripheral(around), error_(error) { reset(); }
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;
  void stand(bool still);

 private:
  void reload();
  void book(Time left);
  double error_;
  Time due_ = 0, left_ = 0;
  bool still_ = false;
  bool running_ = false, unlocked_ = false;
  std::uint32_t prescaler_ = 0, reload_ = 0xFFF;
  std::uint64_t generation_ = 0;
};

}  // namespace triskin::machine
