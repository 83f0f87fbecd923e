// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin_line.hpp"

#include <cmath>
#include <random>

namespace triskin::machine {
namespace {

constexpr std::uint16_t kFirstResult = 0x00B;
constexpr int kBurstBytes = 28;
constexpr std::uint64_t kAddressByte_us = 25;  // A start condition and nine bits precede the call of start().

}  // namespace

double PadSource::counts(int cin, std::uint64_t at_us) const {
  double value = level[static_cast<std::size_t>(cin)] + drift_per_s * static_cast<double>(at_us) * 1e-6;
  if (ramp) value -= std::fmod(std::floor(static_cast<double>(at_us) / kRamp_us), kRampCounts);
  return value;
}

SkinModule& SkinLine::add(std::uint8_t address, int index, std::uint16_t device_id) {
  SkinModule& m = *modules.emplace_back(std::make_unique<SkinModule>());
  m.address = address;
  for (int t = 0; t < layout::kTaxelsPerModule; ++t)
    m.source.level[static_cast<std::size_t>(t)] = 8000.0 - 97.0 * index - 31.0 * t;
  exchange(m, device_id, index);
  return m;
}

void SkinLine::exchange(SkinModule& m, std::uint16_t device_id, int index) {
  m.chip = std::make_unique<hardware::Ad7147>(m.source, device_id);
  m.chip->set_noise(static_cast<std::uint64_t>(1000 + index));
  m.chip->set_behaviour(m.behaviour);
}

void SkinLine::solder_electrodes(SkinModule& m, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> pf(2.0, 18.0);
  for (int t = 0; t < layout::kTaxelsPerModule; ++t)
    m.source.level[static_cast<std::size_t>(t)] = pf(random) * 32768.0 / 8.0;
}

void SkinLine::freeze(SkinModule& m, int taxel, std::uint64_t now_us) {
  m.frozen = static_cast<std::uint16_t>(m.frozen | 1U << taxel);
  m.frozen_value[static_cast<std::size_t>(taxel)] =
      m.chip->read_register(static_cast<std::uint16_t>(kFirstResult + taxel), now_us - origin_us);
}

bool SkinLine::start(std::uint8_t address_byte, std::uint64_t now_us) {
  ++bytes;
  if (first_start_us == 0) first_start_us = now_us;
  if (!in_transaction_) {
    started_us_ = now_us - kAddressByte_us;
    transaction_bytes_ = 0;
  }
  in_transaction_ = true;
  ++transaction_bytes_;
  selected_.clear();
  position_ = 0;
  address_ = static_cast<std::uint8_t>((address_byte >> 1) - layout::kFirstCdcAddress);
  if (scl_held || sda_held) return false;
  for (const auto& m : modules) {
    if (!m->present || m->address != address_) continue;
    m->chip->select((address_byte & 1) != 0, now_us - origin_us);
    selected_.push_back(m.get());
  }
  return !selected_.empty();
}

bool SkinLine::write(std::uint8_t byte, std::uint64_t now_us) {
  ++bytes;
  ++transaction_bytes_;
  if (position_++ < 2) register_ = static_cast<std::uint16_t>(register_ << 8 | byte);
  for (SkinModule* m : selected_) m->chip->write_byte(byte, now_us - origin_us);
  return !selected_.empty();
}

std::uint8_t SkinLine::read(bool, std::uint64_t now_us) {
  ++bytes;
  ++transaction_bytes_;
  const int taxel = register_ + position_ / 2 - kFirstResult;
  std::uint8_t value = 0xFF;
  for (SkinModule* m : selected_) {
    std::uint8_t byte = m->chip->read_byte(now_us - origin_us);
    if (taxel >= 0 && taxel < layout::kTaxelsPerModule && (m->frozen >> taxel & 1) != 0) {
      const std::uint16_t kept = m->frozen_value[static_cast<std::size_t>(taxel)];
      byte = static_cast<std::uint8_t>(position_ % 2 == 0 ? kept >> 8 : kept);
    }
    value = static_cast<std::uint8_t>(value & byte);
  }
  ++position_;
  return value;
}

void SkinLine::stop(std::uint64_t now_us) {
  if (in_transaction_ && transaction_bytes_ == kBurstBytes) bursts.push_back({address_, started_us_, now_us});
  in_transaction_ = false;
  selected_.clear();
  ++stops;
}

void SkinLine::pulse_scl(std::uint64_t) {
  if (++pulses == frees_after_pulses) sda_held = false;
}

}  // namespace triskin::machine
