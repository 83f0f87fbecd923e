// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/chip_setup.hpp"

#include <span>

namespace triskin::fw {

// The earlier offsets are tried first: the chip may be another one of the same kind.
ChipSetup::Next ChipSetup::on_identity(std::uint16_t device_id, PlaceOffsets& place) {
  if (place.known && place.device_id == device_id) {
    offsets_.begin(place.steps);
  } else {
    offsets_.begin();
    single_ = false;
    place.known = false;
  }
  place.device_id = device_id;
  place.state = wire::OffsetState::kSearching;
  place.rest = {};
  return enter(State::kSearch, Next::kConfigure);
}

ChipSetup::Next ChipSetup::on_results(const ad7147::Results& results, PlaceOffsets& place) {
  switch (state_) {
    case State::kSearch:
      if (offsets_.adjust(results, stages().polarity)) return Next::kConfigure;
      if (!single_) {
        duplicates_.begin();
        return enter(State::kOther, Next::kConfigure);
      }
      if (latch_.wanted()) return enter(State::kShifted, Next::kConfigureOffsets);
      settle(results, place);
      return enter(State::kRun, Next::kUse);

    case State::kOther:
      before_ = results;
      return enter(State::kUsed, Next::kConfigure);

    case State::kUsed:
      switch (duplicates_.compare(before_, results, stages().offsets)) {
        case DuplicateCheck::Verdict::kUndecided:
          return enter(State::kOther, Next::kConfigure);
        case DuplicateCheck::Verdict::kDuplicate:
          return enter(State::kFind, Next::kDuplicate);
        case DuplicateCheck::Verdict::kSingle:
          single_ = true;
      }
      return enter(latch_.wanted() ? State::kShifted : State::kSearch, Next::kConfigure);

    case State::kShifted:
      before_ = results;
      latch_.skip();  // what was read in the middle of an earlier sequence
      return enter(State::kLatching, Next::kConfigureOffsets);

    case State::kLatching:
      latch_.compare(before_, results);
      if (latch_.wanted()) return enter(State::kShifted, Next::kConfigureOffsets);
      settle(results, place);
      return enter(State::kRun, Next::kSkip);

    case State::kFind:
    case State::kRun:
      break;
  }
  return Next::kUse;
}

Ad7147::Stages ChipSetup::stages() const {
  const bool positive = (state_ == State::kOther) != positive_;
  Ad7147::Stages stages{positive ? Ad7147::Polarity::kPositive : Ad7147::Polarity::kNegative, offsets_.offsets()};
  if (state_ == State::kOther || state_ == State::kUsed) stages.offsets = duplicates_.offsets(offsets_.offsets());
  if (state_ != State::kShifted) return stages;
  // Large enough to tell with which offsets a result was converted, and small enough to keep it in range.
  constexpr std::uint8_t kShift = 4;
  for (std::uint8_t& o : std::span(stages.offsets).first(LatchProbe::kStages))
    o = static_cast<std::uint8_t>(o < kShift ? o + kShift : o - kShift);
  return stages;
}

// One chip answers and its offsets are final.
void ChipSetup::settle(const ad7147::Results& results, PlaceOffsets& place) const {
  for (std::size_t t = 0; t < results.size(); ++t)
    place.rest[t] = static_cast<std::uint16_t>(positive_ ? ~results[t] : results[t]);  // pressure lowers it
  place.outside = offsets_.outside();
  place.latching = latch_.latching();
  if (!place.known || place.steps != offsets_.offsets()) {
    place.steps = offsets_.offsets();
    place.known = place.to_store = true;
    ++place.searches;
  }
  place.state = place.outside != 0    ? wire::OffsetState::kOutside
                : place.searches == 0 ? wire::OffsetState::kKept
                                      : wire::OffsetState::kFound;
}

}  // namespace triskin::fw
