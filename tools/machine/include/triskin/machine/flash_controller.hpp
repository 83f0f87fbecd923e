// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "triskin/machine/flash_chip.hpp"
#include "triskin/machine/peripheral.hpp"
#include "triskin/machine/system_blocks.hpp"

namespace triskin::machine {

/// Models the flash interface (RM0440 §3.7): keys, lock, page erase, programming of 64-bit units, busy times, error
/// flags, ECC, option bytes, the bank that is busy, the rules of the data cache.
class FlashController final : public Peripheral {
 public:
  static constexpr Time kProgramTime = 82 * kMicrosecond, kEraseTime = 22'000 * kMicrosecond;
  /// Receives cells that changed and from which the core may have read code.
  using Changed = std::function<void(std::uint32_t address, std::uint32_t size)>;

  /// `time_factor` multiplies the typical times. `one_bank` is the flash of the STM32L4 (RM0394): the same registers,
  /// but one bank and none of the debugger's bit.
  FlashController(Surroundings& around, FlashChip& chip, ClockControl& rcc, Changed changed, bool one_bank = false,
                  double time_factor = 1)
      : Peripheral(around),
        chip_(chip),
        rcc_(rcc),
        one_bank_(one_bank),
        time_factor_(time_factor),
        changed_(std::move(changed)) {
    load_options();
    reset();
  }
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;
  /// Reads the option bytes from their cells, as the chip does at power-up and by CR.OBL_LAUNCH, but at no other reset.
  void load_options() {
    loaded_options_ = chip_.options;
    loaded_protection_ = chip_.write_protection;
  }
  [[nodiscard]] std::uint32_t loaded_options() const { return loaded_options_; }
  [[nodiscard]] bool prefetches() const { return (acr_ & 1U << 8) != 0; }
  /// Takes a write of the CPU to the flash's address space.
  void cell_write(std::uint32_t address, std::uint32_t value, unsigned size);
  /// Takes a read of the CPU from a unit that has one wrong bit, which is corrected, or two, or whose neighbour has.
  void flawed_read(std::uint32_t unit);
  /// Returns true while a flag of two wrong bits is set: the NMI comes again and again.
  [[nodiscard]] bool nmi_pending() const;
  /// Returns true while an operation is under way.
  [[nodiscard]] bool busy() const { return busy_; }
  /// Returns true if the address lies in the bank that is being written.
  [[nodiscard]] bool busy_at(std::uint32_t address) const {
    return busy_ && address >= FlashChip::kBase && address < FlashChip::kBase + FlashChip::kBytes &&
           (!two_banks() || (address - FlashChip::kBase) / (FlashChip::kBytes / 2) == busy_bank_);
  }
  [[nodiscard]] Time busy_until() const { return busy_until_; }
  /// Returns true if power failed in an operation, so that the machine must stop.
  [[nodiscard]] bool power_lost() const { return power_lost_; }

 private:
  void note_flaw(std::uint32_t unit, bool upper);
  [[nodiscard]] bool two_banks() const { return !one_bank_ && (loaded_options_ >> 22 & 1) != 0; }
  [[nodiscard]] std::uint32_t page_mask() const { return one_bank_ ? 255 : 127; }
  void write_access(std::uint32_t value);
  void write_option_key(std::uint32_t value);
  void check_data_cache();
  void start_options();
  void launch_options();
  void write_key(std::uint32_t value);
  void write_control(std::uint32_t value);
  void start_erase();
  [[nodiscard]] bool is_protected(std::uint32_t page) const;
  void program_unit();
  void begin(Time typical, const FlashOperation& operation);
  void error(std::uint32_t flag, const char* what);

  FlashChip& chip_;
  ClockControl& rcc_;
  bool one_bank_;
  double time_factor_;
  Changed changed_;
  std::uint32_t acr_ = 0, sr_ = 0, cr_ = 0, eccr_ = 0;
  std::uint32_t options_ = 0, protection_ = 0, loaded_options_ = 0, loaded_protection_ = 0;
  int keys_ = 0, option_keys_ = 0;
  bool locked_out_ = false, power_lost_ = false, launch_ = false;
  bool busy_ = false, stale_ = false;
  std::uint32_t busy_bank_ = 0;
  Time busy_until_ = 0;
  bool half_waits_ = false;
  std::uint32_t half_address_ = 0, words_[2]{};
  std::uint64_t generation_ = 0;
};

}  // namespace triskin::machine
