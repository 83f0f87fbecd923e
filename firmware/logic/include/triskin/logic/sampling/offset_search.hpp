// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"
#include "triskin/wire/offsets.hpp"

namespace triskin::fw {

/// Finds the offset of each stage of a chip: an electrode has some 2 to 18 pF, but the converter covers only ± 8 pF
/// around its offset. Each taxel should rest in the middle third of the range. One reading shows how far off a taxel
/// is; the offset of a taxel at an end of its range moves by half a range. How many counts a step has differs from chip
/// to chip (900 to 1,400 are seen or specified), so it is measured as soon as two readings allow it. Known offsets stay
/// unless their taxel rests outside the middle third. Three to five readings are enough. It makes no transfers: it
/// receives results and gives offsets.
class OffsetSearch {
 public:
  static constexpr std::uint8_t kFirst = 31;  ///< The middle of the offset DAC.
  /// The offset of a taxel at an end of its range moves by this: 5.5 pF at least, with steps of 900 counts.
  static constexpr std::uint8_t kFarStep = 25;
  /// Until it is measured, a step is taken for the geometric mean of 900 (970 were measured, 1,000 seen near mid scale)
  /// and 1,400 (1,311 by the data sheet's 0.32 pF).
  static constexpr std::int32_t kAssumedStep_counts = 1'122;
  /// What is measured of two chips at once, or under a finger, is no step.
  static constexpr std::int32_t kMinStep_counts = 700, kMaxStep_counts = 1'800;
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
  /// brought into the middle third. From then on the offsets count as known.
  [[nodiscard]] bool adjust(const ad7147::Results& results, Ad7147::Polarity polarity);

  /// Returns the steps of each stage, 0 … ad7147::kMaxOffset.
  [[nodiscard]] const ad7147::Offsets& offsets() const { return offsets_; }
  /// Bit t says that taxel t rested outside the middle third in the last reading.
  [[nodiscard]] std::uint16_t outside() const { return outside_; }
  /// Returns the counts of a step, measured or assumed.
  [[nodiscard]] std::int32_t step_counts() const { return step_counts_; }

 private:
  using Excess = std::array<std::int32_t, ad7147::kStages>;  // of the electrode over its offset, in counts
  static constexpr std::int32_t kAtEnd = INT32_MAX;
  void measure_step(const Excess& excess);
  [[nodiscard]] std::uint8_t better(std::uint8_t offset, std::int32_t excess, bool at_end) const;

  ad7147::Offsets offsets_{}, last_offsets_{};
  Excess last_excess_{};  // kAtEnd: says nothing
  std::int32_t step_counts_ = kAssumedStep_counts;
  std::uint16_t outside_ = 0;
  std::uint8_t rounds_ = 0;
  bool known_ = false;
};

static_assert(wire::kMaxOffset == ad7147::kMaxOffset);
static_assert(wire::kRestLeast == ad7147::kMidScale - OffsetSearch::kThird);
static_assert(wire::kRestMost == ad7147::kMidScale + OffsetSearch::kThird);

}  // namespace triskin::fw
