// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "triskin/layout/patch_image.hpp"
#include "triskin/ports/ports.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::fw {

/// Registers of the AD7147 (data sheet rev. E, tables 14–36): 16-bit addresses and values, big-endian.
namespace ad7147 {
inline constexpr std::uint16_t kPowerControl = 0x000, kStageCalibration = 0x001, kAmbientControl = 0x002,
                               kInterruptEnable = 0x005, kStageComplete = 0x00A, kResult = 0x00B, kDeviceId = 0x017,
                               kStage = 0x080;
/// Full power, twelve stages; bits 8 and 9 choose the decimation.
[[nodiscard]] constexpr std::uint16_t power_control(wire::Decimation d) {
  return static_cast<std::uint16_t>(0x00B0 | static_cast<unsigned>(d) << 8);
}
inline constexpr std::uint16_t kAllStages = layout::kAllTaxels;
inline constexpr std::uint16_t kId = 0x1470, kIdMask = 0xFFF0;  ///< low nibble: revision
inline constexpr int kStages = layout::kTaxelsPerModule;
using Results = std::array<std::uint16_t, kStages>;
inline constexpr std::uint16_t kStageStride = 8;
/// Conversion time of twelve stages (data sheet table 11), µs.
[[nodiscard]] constexpr std::uint32_t sequence_us(wire::Decimation d) {
  return wire::sequence_us(d);
}
inline constexpr std::uint32_t kMidScale = 0x8000;
/// A result that is at neither end of the converter's range; a chip without configuration gives 0.
[[nodiscard]] constexpr bool in_range(std::uint16_t result) {
  return result != 0 && result != 0xFFFF;
}
}  // namespace ad7147

/// One CDC on a line: what to write and read, never waiting. Each begin_… starts one transfer on the line; the caller
/// polls the line and then calls the matching finish_….
class Ad7147 {
 public:
  /// Asks the chip at 7-bit `address` for its device id.
  void begin_identify(I2cLine& line, std::uint8_t address);
  /// kOk; kWrongId when the chip is no AD7147. The lower four bits, the revision, may be anything.
  [[nodiscard]] Status finish_identify() const;

  /// Input of the converter that the pads are connected to. It measures at the negative one: pressure lowers the
  /// result, as on the iCub skin. The positive one gives the same number mirrored at mid scale.
  enum class Polarity : std::uint8_t { kPositive, kNegative };
  /// Writes configuration in `kConfigurationSteps` transfers: stages first, power last, which restarts the sequence.
  static constexpr int kConfigurationSteps = ad7147::kStages + 2;
  /// Starts transfer `step`, 0 … kConfigurationSteps − 1, in this order.
  void begin_configure(I2cLine& line, std::uint8_t address, int step, Polarity polarity);

  /// The decimation that begin_configure and begin_restart write.
  void set_decimation(wire::Decimation d) { power_ = ad7147::power_control(d); }
  /// Writes power control alone: the sequence begins anew, the results stay.
  void begin_restart(I2cLine& line, std::uint8_t address);

  /// Reads and so clears the stage-complete status: bit s is set when stage s has been converted since the last
  /// reading.
  void begin_status(I2cLine& line, std::uint8_t address);
  /// What begin_status() read: bit s for stage s, 0..11.
  [[nodiscard]] std::uint16_t status() const;

  /// Reads back what a power dip would clear: power control and calibration enables.
  void begin_verify(I2cLine& line, std::uint8_t address);
  /// True when what begin_verify() read is what was written: no reset in between.
  [[nodiscard]] bool configuration_holds() const;

  /// Twelve results in one burst of 28 bytes.
  void begin_read(I2cLine& line, std::uint8_t address);
  /// What begin_read() read: result of stage 0..11, 16 bits each.
  [[nodiscard]] ad7147::Results results() const;

 private:
  void write_register(std::uint16_t reg);
  std::uint16_t power_ = ad7147::power_control(wire::Decimation::k256);
  std::array<std::uint8_t, 2 + 2 * 8> out_{};
  std::array<std::uint8_t, 2 * ad7147::kStages> in_{};
};

}  // namespace triskin::fw
