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

/// The registers of the AD7147 (data sheet rev. E, tables 14–36) have 16-bit addresses and values, big-endian.
namespace ad7147 {
inline constexpr std::uint16_t kPowerControl = 0x000, kAmbientControl = 0x002, kHighInterruptEnable = 0x006,
                               kStageComplete = 0x00A, kResult = 0x00B, kDeviceId = 0x017, kStage = 0x080;
/// Returns full power with twelve stages; bits 8 and 9 select the decimation.
[[nodiscard]] constexpr std::uint16_t power_control(wire::Decimation d) {
  return static_cast<std::uint16_t>(0x00B0 | static_cast<unsigned>(d) << 8);
}
inline constexpr std::uint16_t kAllStages = layout::kAllTaxels;
inline constexpr std::uint16_t kId = 0x1470, kIdMask = 0xFFF0;  ///< The low nibble is the revision.
inline constexpr int kStages = layout::kTaxelsPerModule;
using Results = std::array<std::uint16_t, kStages>;
/// The mark of the place 0 … 15 (line and address), which is kept in kHighInterruptEnable: with every stage's
/// calibration off, its bits 0 … 11 only drive the interrupt pin, which is not connected. It is 0 after a reset. Four
/// of eight bits are set, so the wired AND of two different marks, or of a mark and 0, is neither.
[[nodiscard]] constexpr std::uint16_t mark(std::size_t place) {
  return static_cast<std::uint16_t>((place & 0xF) | (~place & 0xF) << 4);
}
inline constexpr std::uint16_t kStageStride = 8, kOffsetInStage = 2;
/// This bit of kAmbientControl restarts the sequence at stage 0, keeps the results and clears itself.
inline constexpr std::uint16_t kConvReset = 0x8000;
/// The converter subtracts an offset from the electrode's capacitance at each stage, in steps of nominally 0.32 pF.
using Offsets = std::array<std::uint8_t, kStages>;
inline constexpr std::uint8_t kMaxOffset = 63;
/// In the register, the field of the positive input begins at this bit.
inline constexpr unsigned kPositiveOffset = 8;
/// Returns the conversion time of twelve stages (data sheet table 11) in µs.
[[nodiscard]] constexpr std::uint32_t sequence_us(wire::Decimation d) {
  return wire::sequence_us(d);
}
inline constexpr std::uint32_t kMidScale = 0x8000;
/// Returns true if a result is at neither end of the converter's range; a chip without configuration gives 0.
[[nodiscard]] constexpr bool in_range(std::uint16_t result) {
  return result != 0 && result != 0xFFFF;
}
}  // namespace ad7147

/// The driver of one CDC on a line knows what to write and read, and never waits. Each begin_… starts one transfer on
/// the line; the caller polls the line and then calls the matching finish_….
class Ad7147 {
 public:
  /// Asks the chip at the 7-bit `address` for its device id.
  void begin_identify(I2cLine& line, std::uint8_t address);
  /// Returns kOk, or kWrongId when the chip is not an AD7147. The lower four bits, the revision, may have any value.
  [[nodiscard]] Status finish_identify() const;
  /// Returns the id that was read, with its revision.
  [[nodiscard]] std::uint16_t device_id() const;

  /// The pads are connected to one of the converter's inputs. At the negative one pressure lowers the result, at the
  /// positive one it raises it: the number is mirrored at mid scale.
  enum class Polarity : std::uint8_t { kPositive, kNegative };
  struct Stages {
    Polarity polarity = Polarity::kNegative;
    ad7147::Offsets offsets{};  ///< Each offset is 0 … kMaxOffset.
  };
  /// Writes the configuration in `kConfigurationSteps` transfers: first the stages, then power and calibration, finally
  /// the restart of the sequence. A write to power control alone may leave the sequence anywhere.
  static constexpr int kConfigurationSteps = ad7147::kStages + 2;
  /// Starts transfer `step`, 0 … kConfigurationSteps − 1, in this order. `mark` is written, too, unless it is 0.
  void begin_configure(I2cLine& line, std::uint8_t address, int step, const Stages& stages, std::uint16_t mark);

  /// Writes only the offsets of the first `kOffsetStages` stages, in `kOffsetSteps` transfers between two restarts of
  /// the sequence, so that no sequence ends in between.
  static constexpr int kOffsetStages = 5, kOffsetSteps = kOffsetStages + 2;
  /// Starts transfer `step`, 0 … kOffsetSteps − 1, in this order.
  void begin_offsets(I2cLine& line, std::uint8_t address, int step, const Stages& stages);

  /// Sets the decimation that begin_configure writes.
  void set_decimation(wire::Decimation d) { power_ = ad7147::power_control(d); }
  /// Writes CONV_RESET: the sequence restarts, the results stay.
  void begin_restart(I2cLine& line, std::uint8_t address);

  /// Reads the stage-complete status, which clears it: bit s is set when stage s was converted since the last reading.
  void begin_status(I2cLine& line, std::uint8_t address);
  /// Returns what begin_status() read: bit s for stage s, 0..11.
  [[nodiscard]] std::uint16_t status() const;

  /// Reads back the mark, which a power dip clears and a second chip at the address spoils.
  void begin_verify(I2cLine& line, std::uint8_t address);
  /// Returns the mark that begin_verify() read.
  [[nodiscard]] std::uint16_t mark() const;

  /// Reads twelve results in one burst of 28 bytes.
  void begin_read(I2cLine& line, std::uint8_t address);
  /// Returns what begin_read() read: the results of stages 0..11, 16 bits each.
  [[nodiscard]] ad7147::Results results() const;

 private:
  void write_register(std::uint16_t reg);
  [[nodiscard]] static std::uint16_t offset_word(const Stages& stages, int stage);
  std::uint16_t power_ = ad7147::power_control(wire::Decimation::k256);
  std::array<std::uint8_t, 2 + 2 * 8> out_{};
  std::array<std::uint8_t, 2 * ad7147::kStages> in_{};
};

}  // namespace triskin::fw
