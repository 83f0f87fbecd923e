// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"
#include "triskin/wire/offsets.hpp"

namespace triskin::fw {

/// Finds the offset of each stage of a chip: an electrode has 2 to 18 pF, the converter sees ± 8 pF around its offset.
/// Each taxel is to rest in the middle third of the range. One reading shows how far off a taxel is; a taxel at an end
/// of its range moves by half a range. Offsets that are known stay unless their taxel rests outside the middle third.
/// Three readings are enough for electrodes in 2 … 18 pF. Pure: results in, offsets out.
class OffsetSearch {
 public:
  static constexpr std::uint8_t kFirst = 31;    ///< 9.92 pF: a converter sees 1.92 … 17.92 pF
  static constexpr std::uint8_t kFarStep = 25;  ///< 8 pF: beyond the end of the range
  static constexpr int kMaxRounds = 8;          ///< readings: what does not settle is not one chip
  static constexpr int kCenteringRounds = 4;    ///< … of a search without known offsets that go for the middle
  static constexpr std::int32_t kThird = 0x8000 / 3;

  /// Nothing is known.
  void begin();
  /// Offsets that were right before.
  void begin(const ad7147::Offsets& known);
  /// `results` were read with offsets() at the input `polarity`. True: the offsets have changed, configure and read
  /// again. False: they stand; outside() tells which taxels could not be brought where they belong.
  [[nodiscard]] bool adjust(const ad7147::Results& results, Ad7147::Polarity polarity);

  /// Steps of each stage, 0 … ad7147::kMaxOffset.
  [[nodiscard]] const ad7147::Offsets& offsets() const { return offsets_; }
  /// Bit t: taxel t rested outside the middle third in the last reading.
  [[nodiscard]] std::uint16_t outside() const { return outside_; }

 private:
  [[nodiscard]] static std::uint8_t better(std::uint8_t offset, std::int32_t excess_counts, bool at_end);

  ad7147::Offsets offsets_{};
  std::uint16_t outside_ = 0;
  std::uint8_t rounds_ = 0;
  bool known_ = false;
};

static_assert(wire::kMaxOffset == ad7147::kMaxOffset);
static_assert(wire::kRestLeast == ad7147::kMidScale - OffsetSearch::kThird);
static_assert(wire::kRestMost == ad7147::kMidScale + OffsetSearch::kThird);

}  // namespace triskin::fw
