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
inline constexpr std::uint16_t kStageStride = 8, kOffsetInStage = 2;
/// Bit of kAmbientControl that restarts the sequence at stage 0, keeps the results and clears itself.
inline constexpr std::uint16_t kConvReset = 0x8000;
/// Offset of each stage, in steps of 0.32 pF: what the converter takes away from the electrode's capacitance.
using Offsets = std::array<std::uint8_t, kStages>;
inline constexpr std::uint8_t kMaxOffset = 63;
inline constexpr unsigned kPositiveOffset = 8;       ///< bit of the register where the positive input's begins
inline constexpr std::int32_t kOffsetCounts = 1311;  ///< one step moves the result by this: 0.32 pF of 8 pF / 32768
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
  /// The id that was read, with its revision.
  [[nodiscard]] std::uint16_t device_id() const;

  /// Input of the converter that the pads are connected to. At the negative one pressure lowers the result; at the
  /// positive one it raises it: the same number mirrored at mid scale.
  enum class Polarity : std::uint8_t { kPositive, kNegative };
  /// What the stages are set up for.
  struct Stages {
    Polarity polarity = Polarity::kNegative;
    ad7147::Offsets offsets{};  ///< 0 … kMaxOffset each
  };
  /// Writes configuration in `kConfigurationSteps` transfers: stages first, then power and calibration, at last the
  /// restart of the sequence. A write to power control may, on its own, leave the sequence anywhere.
  static constexpr int kConfigurationSteps = ad7147::kStages + 2;
  /// Starts transfer `step`, 0 … kConfigurationSteps − 1, in this order.
  void begin_configure(I2cLine& line, std::uint8_t address, int step, const Stages& stages);

  /// Writes the offsets of the first `kOffsetStages` stages alone, in `kOffsetSteps` transfers between two restarts of
  /// the sequence: none ends meanwhile.
  static constexpr int kOffsetStages = 5, kOffsetSteps = kOffsetStages + 2;
  /// Starts transfer `step`, 0 … kOffsetSteps − 1, in this order.
  void begin_offsets(I2cLine& line, std::uint8_t address, int step, const Stages& stages);

  /// The decimation that begin_configure writes.
  void set_decimation(wire::Decimation d) { power_ = ad7147::power_control(d); }
  /// Writes CONV_RESET: the sequence begins anew, the results stay.
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
  [[nodiscard]] static std::uint16_t offset_word(const Stages& stages, int stage);
  std::uint16_t power_ = ad7147::power_control(wire::Decimation::k256);
  std::array<std::uint8_t, 2 + 2 * 8> out_{};
  std::array<std::uint8_t, 2 * ad7147::kStages> in_{};
};

}  // namespace triskin::fw
