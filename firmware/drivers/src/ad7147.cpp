// SPDX-License-Identifier: Apache-2.0
#include "triskin/drivers/ad7147.hpp"

namespace triskin::fw {
namespace {

std::uint16_t big16(std::span<const std::uint8_t> b) {
  return static_cast<std::uint16_t>(b[0] << 8 | b[1]);
}

}  // namespace

void Ad7147::write_register(std::uint16_t reg) {
  out_[0] = static_cast<std::uint8_t>(reg >> 8);
  out_[1] = static_cast<std::uint8_t>(reg);
}

void Ad7147::begin_identify(I2cLine& line, std::uint8_t address) {
  write_register(ad7147::kDeviceId);
  line.start(address, std::span(out_).first(2), std::span(in_).first(2));
}

Status Ad7147::finish_identify() const {
  return (big16(in_) & ad7147::kIdMask) == ad7147::kId ? Status::kOk : Status::kWrongId;
}

std::uint16_t Ad7147::device_id() const {
  return big16(in_);
}

void Ad7147::begin_configure(I2cLine& line, std::uint8_t address, int step, const Stages& stages, std::uint16_t mark) {
  ByteWriter w(out_);
  if (step < ad7147::kStages) {
    // Stage s converts only input s, single ended, with its offset at the same input and the clamps wide open.
    w.be16(static_cast<std::uint16_t>(ad7147::kStage + step * ad7147::kStageStride));
    // Each input has two bits: 11 for BIAS, 10 for the positive side, 01 for the negative. The high word has CIN7 …
    // 12, then 01 or 10 for single ended, positive or negative.
    const bool positive = stages.polarity == Polarity::kPositive;
    const unsigned cleared = 1U << (2 * (step < 7 ? step : step - 7) + (positive ? 0 : 1));
    const unsigned low = step < 7 ? 0x3FFFU & ~cleared : 0x3FFFU;
    const unsigned high = step < 7 ? 0x0FFFU : 0x0FFFU & ~cleared;
    w.be16(static_cast<std::uint16_t>(low));
    w.be16(static_cast<std::uint16_t>((positive ? 0x1000U : 0x2000U) | high));
    w.be16(offset_word(stages, step));
    w.be16(0x2626);  // The sensitivity is the data sheet's typical value.
    w.be16(0x2710);  // The low offset only affects threshold interrupts, which are off.
    w.be16(0x2710);  // The high offset only affects threshold interrupts, which are off.
    w.be16(0x7530);  // The high clamp is wide open.
    w.be16(0x0000);  // The low clamp is wide open.
  } else if (step == ad7147::kStages) {
    w.be16(ad7147::kPowerControl);
    w.be16(power_);
    w.be16(
        0x0000);  // No stage is calibrated by the chip, because the controller compensates itself; as iCub's boards do.
    w.be16(0x0000);  // So the control registers of the ambient compensation have no effect.
    w.be16(0x0000);
    w.be16(0x0000);
    w.be16(0x0000);  // Interrupts of the low thresholds are off.
    if (mark != 0) {
      w.be16(mark);
      w.be16(ad7147::kAllStages);  // The status reports complete stages; the interrupt pin is not connected.
    }
  } else {
    return begin_restart(line, address);
  }
  line.start(address, w.written(), {});
}

std::uint16_t Ad7147::offset_word(const Stages& stages, int stage) {
  const unsigned offset = stages.offsets[static_cast<std::size_t>(stage)];
  return static_cast<std::uint16_t>(stages.polarity == Polarity::kPositive ? offset << ad7147::kPositiveOffset
                                                                           : offset);
}

void Ad7147::begin_offsets(I2cLine& line, std::uint8_t address, int step, const Stages& stages) {
  if (step == 0 || step + 1 == kOffsetSteps) return begin_restart(line, address);
  const int stage = step - 1;
  ByteWriter w(out_);
  w.be16(static_cast<std::uint16_t>(ad7147::kStage + stage * ad7147::kStageStride + ad7147::kOffsetInStage));
  w.be16(offset_word(stages, stage));
  line.start(address, w.written(), {});
}

void Ad7147::begin_restart(I2cLine& line, std::uint8_t address) {
  ByteWriter w(out_);
  w.be16(ad7147::kAmbientControl);
  w.be16(ad7147::kConvReset);
  line.start(address, w.written(), {});
}

void Ad7147::begin_status(I2cLine& line, std::uint8_t address) {
  write_register(ad7147::kStageComplete);
  line.start(address, std::span(out_).first(2), std::span(in_).first(2));
}

std::uint16_t Ad7147::status() const {
  return big16(in_);
}

void Ad7147::begin_verify(I2cLine& line, std::uint8_t address) {
  write_register(ad7147::kHighInterruptEnable);
  line.start(address, std::span(out_).first(2), std::span(in_).first(2));
}

std::uint16_t Ad7147::mark() const {
  return big16(in_);
}

void Ad7147::begin_read(I2cLine& line, std::uint8_t address) {
  write_register(ad7147::kResult);
  line.start(address, std::span(out_).first(2), in_);
}

ad7147::Results Ad7147::results() const {
  ad7147::Results r{};
  for (std::size_t k = 0; k < r.size(); ++k) r[k] = big16(std::span(in_).subspan(2 * k));
  return r;
}

}  // namespace triskin::fw
