// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/i2c_line.hpp"

#include <algorithm>

namespace triskin::hardware {

void I2cLineModel::hold_low(Signal signal, std::uint64_t at_us, int frees_after_pulses, std::uint64_t until_us) {
  (signal == Signal::kSda ? sda_ : scl_).push_back({at_us, until_us, frees_after_pulses});
}

bool I2cLineModel::is_held(const std::vector<Hold>& holds, std::uint64_t at_us) {
  return std::ranges::any_of(holds, [&](const Hold& h) { return at_us >= h.at_us && at_us < h.until_us; });
}

std::optional<sim::ChipReading> I2cLineModel::look(std::uint8_t address, std::uint64_t at_us) const {
  if (is_held(sda_, at_us) || is_held(scl_, at_us)) return std::nullopt;
  const Ad7147* only = nullptr;
  for (const Chip& c : chips_) {
    if ((c.address_at ? c.address_at(at_us) : c.address) != address) continue;
    if (only != nullptr) return std::nullopt;
    only = c.chip;
  }
  return only == nullptr ? std::nullopt : only->look(at_us);
}

bool I2cLineModel::start(std::uint8_t address_byte, std::uint64_t now_us) {
  now_us_ = now_us;
  selected_.clear();
  if (!usable()) return false;
  ++bytes_;
  for (const Chip& c : chips_) {
    const int address = c.address_at ? c.address_at(now_us) : c.address;
    if (address != address_byte >> 1 || !c.chip->is_powered(now_us)) continue;
    c.chip->select((address_byte & 1) != 0, now_us);
    selected_.push_back(c.chip);
  }
  return !selected_.empty();
}

bool I2cLineModel::write(std::uint8_t byte, std::uint64_t now_us) {
  now_us_ = now_us;
  if (!usable()) return false;
  ++bytes_;
  for (Ad7147* chip : selected_) chip->write_byte(byte, now_us);
  return !selected_.empty();
}

std::uint8_t I2cLineModel::read(bool /*acknowledge*/, std::uint64_t now_us) {
  now_us_ = now_us;
  if (!usable()) return sda() ? 0xFF : 0x00;
  ++bytes_;
  std::uint8_t byte = 0xFF;
  for (Ad7147* chip : selected_) byte = static_cast<std::uint8_t>(byte & chip->read_byte(now_us));
  return byte;
}

void I2cLineModel::stop(std::uint64_t now_us) {
  now_us_ = now_us;
  selected_.clear();
}

bool I2cLineModel::scl() const {
  return !(held_ && held_()) && !is_held(scl_, now_us_);
}
bool I2cLineModel::sda() const {
  return !(held_ && held_()) && !is_held(sda_, now_us_);
}

void I2cLineModel::pulse_scl(std::uint64_t now_us) {
  now_us_ = now_us;
  if (sda_.empty() || !scl()) return;
  std::erase_if(sda_, [](Hold& h) { return h.pulses_left > 0 && --h.pulses_left == 0; });
}

}  // namespace triskin::hardware
