// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "triskin/hardware/ad7147.hpp"
#include "triskin/sim/i2c_bus.hpp"

namespace triskin::hardware {

/// The model is one I²C line with chips on it. Two chips at one address answer together, and their data combine as a
/// wired AND, as on open-drain wires. Not thread-safe.
class I2cLineModel final : public sim::I2cBus {
 public:
  enum class Signal { kSda, kScl };

  /// Connects a chip at the 7-bit address `address`; `chip` must outlive the line.
  void attach(Ad7147& chip, std::uint8_t address) { chips_.push_back({&chip, address}); }
  /// Connects a chip whose place changes: `address_at` returns its 7-bit address at a virtual time in µs, or −1
  /// while it is not on this line.
  void attach(Ad7147& chip, std::function<int(std::uint64_t)> address_at) {
    chips_.push_back({&chip, 0, std::move(address_at)});
  }
  /// Keeps both signals low while `held` returns true; replaces an earlier function.
  void hold_while(std::function<bool()> held) { held_ = std::move(held); }
  /// Holds the signal low from virtual time `at_us` until `until_us`, exclusive. SDA is released after
  /// `frees_after_pulses` pulses on SCL; with 0, pulses do not release it.
  void hold_low(Signal signal, std::uint64_t at_us, int frees_after_pulses, std::uint64_t until_us = ~std::uint64_t{0});

  bool start(std::uint8_t address_byte, std::uint64_t now_us) override;
  bool write(std::uint8_t byte, std::uint64_t now_us) override;
  std::uint8_t read(bool acknowledge, std::uint64_t now_us) override;
  void stop(std::uint64_t now_us) override;
  [[nodiscard]] bool scl() const override;
  [[nodiscard]] bool sda() const override;
  void pulse_scl(std::uint64_t now_us) override;

  /// Returns what a reading of the chip with this 7-bit address would give, without a transfer. Empty if the line is
  /// stuck, or if not exactly one chip with results is there.
  [[nodiscard]] std::optional<sim::ChipReading> look(std::uint8_t address, std::uint64_t at_us) const;

  /// Counts the bytes transferred since construction, including address bytes.
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

 private:
  struct Chip {
    Ad7147* chip;
    std::uint8_t address;
    std::function<int(std::uint64_t)> address_at = {};
  };
  struct Hold {
    std::uint64_t at_us = 0, until_us = 0;
    int pulses_left = 0;
  };
  [[nodiscard]] static bool is_held(const std::vector<Hold>& holds, std::uint64_t at_us);
  [[nodiscard]] bool usable() const { return scl() && sda(); }

  std::vector<Chip> chips_;
  std::vector<Ad7147*> selected_;
  std::function<bool()> held_;
  std::vector<Hold> sda_, scl_;
  std::uint64_t now_us_ = 0;
  std::uint64_t bytes_ = 0;
};

}  // namespace triskin::hardware
