// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"
#include "triskin/wire/offsets.hpp"

namespace triskin::fw {

/// Finds the offset of each stage of a chip: an electrode has 2 to 18 pF, but the converter covers only ± 8 pF around
/// its offset. Each taxel should rest in the middle third of the range. One reading shows how far off a taxel is; the
/// offset of a taxel at an end of its range moves by half a range. Known offsets stay unless their taxel rests outside
/// the middle third. Three readings are enough for electrodes in 2 … 18 pF. It makes no transfers: it receives
/// results and gives offsets.
class OffsetSearch {
 public:
  static constexpr std::uint8_t kFirst = 31;    ///< At 9.92 pF a converter covers 1.92 … 17.92 pF.
  static constexpr std::uint8_t kFarStep = 25;  ///< A step of 8 pF reaches beyond the end of the range.
  /// If the search does not settle within so many readings, there is more than one chip.
  static constexpr int kMaxRounds = 8;
  /// Of a search without known offsets, so many readings aim for the middle.
  static constexpr int kCenteringRounds = 4;
  static constexpr std::int32_t kThird = 0x8000 / 3;

  /// Starts a search in which no offset is known.
  void begin();
  /// Starts with offsets that were right before.
  void begin(const ad7147::Offsets& known);
  /// Evaluates `results`, read with offsets() at the input `polarity`. Returns true if the offsets have changed and the
  /// chip must be configured and read again; false if they are final, and outside() tells which taxels could not be
  /// brought into the middle third.
  [[nodiscard]] bool adjust(const ad7147::Results& results, Ad7147::Polarity polarity);

  /// Returns the steps of each stage, 0 … ad7147::kMaxOffset.
  [[nodiscard]] const ad7147::Offsets& offsets() const { return offsets_; }
  /// Bit t says that taxel t rested outside the middle third in the last reading.
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
