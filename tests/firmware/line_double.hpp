// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "triskin/sim/i2c_bus.hpp"

namespace triskin::test {

/// Models an AD7147 as far as the data sheet binds the firmware: registers, device id, results of the connected inputs.
/// Written for these tests alone, independently of the chips of host/sim/hardware. Stages end one after another; a
/// sequence takes 36.9 ms from the writing of CONV_RESET.
struct ChipDouble {
  static constexpr std::uint64_t kSequence_us = 36'900;
  std::uint8_t address = 0x2C;
  std::uint16_t device_id = 0x1470;
  bool powered = true;
  std::array<int, 12> counts{};  ///< Each electrode has this capacitance in units of 8 pF / 32768.
  int noise = 3;                 ///< Values change from sequence to sequence by up to this amplitude.
  std::uint16_t frozen = 0;      ///< Bit t switches off the noise at input t.
  std::map<std::uint16_t, std::uint16_t> registers;
  std::uint64_t started_us = 0;
  int configurations = 0;  ///< Writes to power control are counted.

  void dip() { registers.clear(); }

  [[nodiscard]] std::uint16_t read(std::uint16_t reg, std::uint64_t now_us) {
    if (reg == 0x017) return device_id;
    if (reg == 0x00A) return status(now_us);
    if (reg >= 0x00B && reg <= 0x016) return result(reg - 0x00B, now_us);
    return registers[reg];
  }
  void write(std::uint16_t reg, std::uint16_t value, std::uint64_t now_us) {
    if (reg >= 0x080 && registers[reg] != value) hold(now_us);
    registers[reg] = value;
    if (reg == 0) ++configurations;
    if (reg != 0x002 || (value & 0x8000) == 0) return;
    registers[reg] = value & 0x7FFF;
    hold(now_us);
    started_us = status_us_ = now_us;
  }

 private:
  std::uint64_t status_us_ = 0;
  std::array<std::uint16_t, 12> held_{};  // Results stay until a stage ends anew.
  std::uint64_t held_us_ = 0;

  void hold(std::uint64_t now_us) {
    std::array<std::uint16_t, 12> shown{};
    for (int s = 0; s < 12; ++s) shown[static_cast<std::size_t>(s)] = result(s, now_us);
    held_ = shown;
    held_us_ = now_us;
  }
  // Returns how often a stage has ended since the start; the status reports those since it was last read.
  [[nodiscard]] std::uint64_t ends(unsigned stage, std::uint64_t at_us) const {
    return (at_us - started_us + kSequence_us * (11 - stage) / 12) / kSequence_us;
  }
  std::uint16_t status(std::uint64_t now_us) {
    unsigned bits = 0;
    for (unsigned s = 0; s < 12 && registers[0] == 0x00B0; ++s)
      bits |= (ends(s, now_us) > ends(s, status_us_) ? 1U : 0U) << s;
    status_us_ = now_us;
    return static_cast<std::uint16_t>(bits);
  }
  std::uint16_t result(int stage, std::uint64_t now_us) {
    if (registers[0] != 0x00B0) return 0;
    const auto sequence = ends(static_cast<unsigned>(stage), now_us);
    if (sequence == ends(static_cast<unsigned>(stage), std::max(held_us_, started_us)))
      return held_[static_cast<std::size_t>(stage)];
    const auto base = static_cast<std::uint16_t>(0x080 + 8 * stage);
    const unsigned both = registers[base] | static_cast<unsigned>(registers[static_cast<std::uint16_t>(base + 1)])
                                                << 14;
    const unsigned connection = both >> (2 * stage) & 3;
    if (connection != 1 && connection != 2) return 0x8000;
    const int wobble = (frozen >> stage & 1) != 0
                           ? 0
                           : static_cast<int>((sequence * 7 + static_cast<unsigned>(stage) * 5) % 11) * noise / 10;
    // The low byte sets the negative input, in steps of 0.32 pF.
    const unsigned afe = registers[static_cast<std::uint16_t>(base + 2)];
    const auto offset = static_cast<int>(std::lround((connection == 2 ? afe >> 8 & 0x3F : afe & 0x3F) * 0.32 * 4096));
    const int value = 0x8000 + (connection == 2 ? 1 : -1) * (counts[static_cast<std::size_t>(stage)] - offset + wobble);
    return static_cast<std::uint16_t>(std::min(0xFFFF, std::max(0, value)));
  }
};

/// Simulates a line with chips; two at one address answer together as on open-drain wires.
class LineDouble final : public sim::I2cBus {
 public:
  std::vector<ChipDouble> chips;
  bool sda_low = false, scl_low = false;
  int frees_after_pulses = 0;  ///< Zero means that the line never becomes free.
  int pulses = 0, starts = 0;

  bool start(std::uint8_t address_byte, std::uint64_t now_us) override {
    now_us_ = now_us;
    ++starts;
    selected_.clear();
    reading_ = (address_byte & 1) != 0;
    for (ChipDouble& c : chips) {
      if (c.powered && c.address == address_byte >> 1) selected_.push_back(&c);
    }
    written_ = 0;
    return !selected_.empty() && !stuck();
  }
  bool write(std::uint8_t byte, std::uint64_t now_us) override {
    if (written_ < 2) {
      register_ = static_cast<std::uint16_t>(register_ << 8 | byte);
    } else if (written_ % 2 == 0) {
      high_ = byte;
    } else {
      for (ChipDouble* c : selected_) c->write(register_, static_cast<std::uint16_t>(high_ << 8 | byte), now_us);
      ++register_;
    }
    ++written_;
    high_next_ = true;
    return !selected_.empty() && !stuck();
  }
  std::uint8_t read(bool /*acknowledge*/, std::uint64_t now_us) override {
    if (high_next_) {
      outgoing_ = 0xFFFF;
      for (ChipDouble* c : selected_) outgoing_ &= c->read(register_, now_us);
    }
    const auto byte = static_cast<std::uint8_t>(high_next_ ? outgoing_ >> 8 : outgoing_);
    if (!high_next_) ++register_;
    high_next_ = !high_next_;
    return byte;
  }
  void stop(std::uint64_t) override { selected_.clear(); }
  [[nodiscard]] bool scl() const override { return !scl_low; }
  [[nodiscard]] bool sda() const override { return !sda_low; }
  void pulse_scl(std::uint64_t) override {
    ++pulses;
    if (frees_after_pulses > 0 && pulses >= frees_after_pulses) sda_low = false;
  }

 private:
  [[nodiscard]] bool stuck() const { return sda_low || scl_low; }
  std::vector<ChipDouble*> selected_;
  std::uint16_t register_ = 0;
  unsigned outgoing_ = 0;  ///< A register is sampled when its high byte is sent.
  std::uint8_t high_ = 0;
  int written_ = 0;
  bool reading_ = false, high_next_ = true;
  std::uint64_t now_us_ = 0;
};

}  // namespace triskin::test
