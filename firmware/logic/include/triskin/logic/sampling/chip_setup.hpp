// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"
#include "triskin/logic/sampling/duplicate_check.hpp"
#include "triskin/logic/sampling/latch_probe.hpp"
#include "triskin/logic/sampling/offset_search.hpp"
#include "triskin/logic/storage/offset_store.hpp"

namespace triskin::fw {

/// The way of one chip from an address to readings that count:
///
///     find ─ id ─▶ search ◀─▶ other ◀─▶ used ─▶ shifted ─▶ latching ─▶ run
///
/// In `search` it is read at the input that is used until the offsets fit. `other` and `used` read both inputs with
/// the offsets of DuplicateCheck, until it is known to be one chip. `shifted` and `latching` tell when the chip shows
/// its results, once after power-up: it is read with other offsets in its first stages, then in mid-sequence and at the
/// end with the final ones. A chip of which all this is known goes from `search` to `run` at once.
///
/// A pure state machine: it makes no transfers and knows no time. It receives what a transfer gave and says which one
/// is next.
class ChipSetup {
 public:
  enum class State : std::uint8_t { kFind, kSearch, kOther, kUsed, kShifted, kLatching, kRun };
  enum class Next : std::uint8_t {
    kConfigure,         ///< write all stages(), restart the sequence and read the results at its end
    kConfigureOffsets,  ///< the same, but only the offsets of the first stages change
    kUse,               ///< the chip runs and these results count
    kSkip,              ///< the chip runs; these results may be of two sequences, the next ones count
    kDuplicate,         ///< two chips answer
  };

  /// `positive`: the electrodes are on the positive input. Call it before anything else.
  void begin(bool positive) { positive_ = positive; }

  /// The chip must be identified again. What is known of it stays.
  void find() { state_ = State::kFind; }
  /// The next chip at this address may be another one, or two.
  void forget_chip() { single_ = false; }
  /// The chip is to be checked whole, with when it shows its results.
  void forget_checks() {
    single_ = false;
    latch_.forget();
  }
  /// The chip runs on as it was before find().
  void take_up() {
    state_ = State::kRun;
    single_ = true;
  }

  /// An AD7147 with this id answered. `place` has the offsets that fitted here before.
  [[nodiscard]] Next on_identity(std::uint16_t device_id, PlaceOffsets& place);
  /// Results of a complete sequence that was converted with stages().
  [[nodiscard]] Next on_results(const ad7147::Results& results, PlaceOffsets& place);
  /// Results that were read in mid-sequence, between those of `shifted` and `latching`.
  void on_middle(const ad7147::Results& results) { latch_.store(results); }

  /// True if the mark of the place is written with stages(). It is written before the comparison of both inputs and not
  /// after it: a chip that joins later is without it, and both are found to be without it.
  [[nodiscard]] bool marks() const { return state_ == State::kSearch && !single_; }
  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] bool runs() const { return state_ == State::kRun; }
  [[nodiscard]] Ad7147::Stages stages() const;
  [[nodiscard]] wire::Latching latching() const { return latch_.latching(); }

 private:
  [[nodiscard]] Next enter(State state, Next next) {
    state_ = state;
    return next;
  }
  void settle(const ad7147::Results& results, PlaceOffsets& place) const;

  State state_ = State::kFind;
  bool positive_ = false;
  bool single_ = false;       // one chip was found here since it was last absent
  ad7147::Results before_{};  // of the state before: at the other input, or with shifted offsets
  OffsetSearch offsets_;
  DuplicateCheck duplicates_;
  LatchProbe latch_;
};

}  // namespace triskin::fw
