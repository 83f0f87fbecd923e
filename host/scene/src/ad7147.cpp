// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/scene/ad7147.hpp"

#include <algorithm>
#include <cmath>

namespace triskin::scene {
namespace {

// Register names and fields: AD7147 data sheet rev. E, tables 20 to 24 and 48 to 52.
constexpr std::uint16_t kPwrControl = 0x000;
constexpr std::uint16_t kStageCompleteStatus = 0x00A;
constexpr std::uint16_t kResults = 0x00B;
constexpr std::uint16_t kDeviceIdRegister = 0x017;
constexpr std::uint16_t kStageSetup = 0x080;
constexpr int kRegistersPerStage = 8;
constexpr int kPins = 13;
constexpr int kPinsInLowRegister = 7;

constexpr int kMidScale = 0x8000;
constexpr double kCountsPerAfeStep = 0.32 / 8.0 * 32768.0;  // offset DAC: 0.32 pF a step; converter: ±8 pF

constexpr std::uint64_t kSequenceUs[] = {36'900, 18'400, 9'200, 9'200};  // 12 stages, per decimation field
constexpr std::uint64_t kLowPowerDelayUs[] = {200'000, 400'000, 600'000, 800'000};

int power_mode(std::uint16_t pwr) { return pwr & 3; }

// Connection field of a pin: 0 open, 1 negative input, 2 positive input, 3 bias.
int connection(const std::uint16_t* stage, int pin) {
  const bool low = pin < kPinsInLowRegister;
  return (stage[low ? 0 : 1] >> (2 * (low ? pin : pin - kPinsInLowRegister))) & 3;
}

// A six-bit offset step count with its swap bit (bit 7 of the field): positive adds to the result.
double afe_counts(std::uint16_t afe) {
  const double negative = (afe & 0x3F) * ((afe & 0x80) != 0 ? -1.0 : 1.0);
  const double positive = ((afe >> 8) & 0x3F) * ((afe & 0x8000) != 0 ? -1.0 : 1.0);
  return (negative - positive) * kCountsPerAfeStep;
}

}  // namespace

void Ad7147::schedule_power_dip(std::uint64_t at_us, std::uint64_t every_us) {
  next_dip_us_ = at_us;
  dip_every_us_ = every_us;
}

void Ad7147::reset(std::uint64_t now_us) {
  setup_.fill(0);
  stage_.fill(0);
  latched_.fill(0);
  restart_us_ = status_read_us_ = now_us;
}

void Ad7147::apply_power_dips(std::uint64_t now_us) {
  if (now_us < next_dip_us_) return;
  std::uint64_t last = next_dip_us_;
  if (dip_every_us_ != 0) last += (now_us - next_dip_us_) / dip_every_us_ * dip_every_us_;
  reset(last);
  next_dip_us_ = dip_every_us_ != 0 ? last + dip_every_us_ : kNever;
}

void Ad7147::select(bool read, std::uint64_t now_us) {
  apply_power_dips(now_us);
  high_byte_next_ = true;
  if (!read) address_bytes_ = 0;
}

void Ad7147::write_byte(std::uint8_t byte, std::uint64_t now_us) {
  if (address_bytes_ < 2) {
    pointer_ = static_cast<std::uint16_t>((address_bytes_ == 0 ? 0 : pointer_ << 8) | byte);
    ++address_bytes_;
    return;
  }
  if (high_byte_next_) {
    half_ = byte;
  } else {
    write_register(pointer_++, static_cast<std::uint16_t>((half_ << 8) | byte), now_us);
  }
  high_byte_next_ = !high_byte_next_;
}

std::uint8_t Ad7147::read_byte(std::uint64_t now_us) {
  if (high_byte_next_) outgoing_ = read_register(pointer_++, now_us);
  const int byte = high_byte_next_ ? outgoing_ >> 8 : outgoing_ & 0xFF;
  high_byte_next_ = !high_byte_next_;
  return static_cast<std::uint8_t>(byte);
}

std::uint16_t Ad7147::read_register(std::uint16_t address, std::uint64_t now_us) {
  apply_power_dips(now_us);
  if (address < kSetupRegisters) return setup_[address];
  if (address == kStageCompleteStatus) return complete_status(now_us);
  if (address >= kResults && address < kResults + kStages) return result(address - kResults, now_us);
  if (address == kDeviceIdRegister) return device_id_;
  if (address >= kStageSetup && address < kStageSetup + kStageRegisters) return stage_[address - kStageSetup];
  return 0;
}

void Ad7147::write_register(std::uint16_t address, std::uint16_t value, std::uint64_t now_us) {
  apply_power_dips(now_us);
  if (address == kPwrControl) {
    constexpr std::uint16_t kSoftwareReset = 1U << 10;
    if ((value & kSoftwareReset) != 0) return reset(now_us);
    latch_results(now_us);
    restart_us_ = now_us;
  }
  if (address < kSetupRegisters) setup_[address] = value;
  if (address >= kStageSetup && address < kStageSetup + kStageRegisters) stage_[address - kStageSetup] = value;
}

void Ad7147::latch_results(std::uint64_t now_us) {
  for (int s = 0; s < kStages; ++s) latched_[static_cast<std::size_t>(s)] = result(s, now_us);
}

int Ad7147::stages_on() const { return std::min(kStages, ((setup_[kPwrControl] >> 4) & 0xF) + 1); }

bool Ad7147::converting() const { return (power_mode(setup_[kPwrControl]) & 1) == 0; }

std::uint64_t Ad7147::stage_us() const { return kSequenceUs[(setup_[kPwrControl] >> 8) & 3] / kStages; }

std::uint64_t Ad7147::sequence_us() const {
  return kSequenceUs[(setup_[kPwrControl] >> 8) & 3] * static_cast<std::uint64_t>(stages_on()) / kStages;
}

std::uint64_t Ad7147::period_us() const {
  const bool low_power = power_mode(setup_[kPwrControl]) == 2;
  return sequence_us() + (low_power ? kLowPowerDelayUs[(setup_[kPwrControl] >> 2) & 3] : 0);
}

std::uint64_t Ad7147::last_conversion_us(int stage, std::uint64_t now_us) const {
  if (!converting() || stage >= stages_on()) return kNever;
  const std::uint64_t first = restart_us_ + stage_us() * static_cast<std::uint64_t>(stage + 1);
  if (now_us < first) return kNever;
  return first + (now_us - first) / period_us() * period_us();
}

std::uint16_t Ad7147::convert(int stage, std::uint64_t at_us) const {
  const std::uint16_t* setup = &stage_[static_cast<std::size_t>(stage * kRegistersPerStage)];
  double value = kMidScale;
  bool connected = false;
  for (int pin = 0; pin < kPins; ++pin) {
    const int to = connection(setup, pin);
    if (to != 1 && to != 2) continue;
    connected = true;
    value += (to == 1 ? -1.0 : 1.0) * source_->counts(pin, at_us);
  }
  if (!connected) return kMidScale;
  value += afe_counts(setup[2]);
  return static_cast<std::uint16_t>(std::clamp(std::lround(value), 0L, 0xFFFFL));
}

std::uint16_t Ad7147::result(int stage, std::uint64_t now_us) const {
  const std::uint64_t at_us = last_conversion_us(stage, now_us);
  return at_us == kNever ? latched_[static_cast<std::size_t>(stage)] : convert(stage, at_us);
}

std::uint16_t Ad7147::complete_status(std::uint64_t now_us) {
  int status = 0;
  for (int s = 0; s < kStages; ++s) {
    const std::uint64_t at_us = last_conversion_us(s, now_us);
    if (at_us != kNever && at_us > status_read_us_) status |= 1 << s;
  }
  status_read_us_ = now_us;
  return static_cast<std::uint16_t>(status);
}

}  // namespace triskin::scene
