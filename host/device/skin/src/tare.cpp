// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/skin/tare.hpp"

#include <algorithm>
#include <bit>

namespace triskin::skin {

void Tare::begin(std::uint64_t now_us) {
  touches_.tare();
  std::ranges::fill(valid_, std::uint16_t{0});
  begun_us_ = now_us;
  state_ = State::kRunning;
}

void Tare::add(const session::ModuleSample& sample) {
  const auto module = static_cast<std::size_t>(sample.module);
  if (sample.sample.valid == 0) return;
  heard_.at(module) = true;
  valid_.at(module) |= sample.sample.valid;
}

std::uint32_t Tare::taxels() const {
  std::uint32_t sum = 0;
  for (const std::uint16_t valid : valid_) sum += static_cast<std::uint32_t>(std::popcount(valid));
  return sum;
}

bool Tare::all_heard() const {
  for (std::size_t m = 0; m < heard_.size(); ++m) {
    if (heard_[m] && valid_[m] == 0) return false;
  }
  return true;
}

Tare::State Tare::step(std::uint64_t now_us) {
  if (state_ != State::kRunning) return state_;
  const bool any = taxels() > 0, over = now_us >= begun_us_ + kLimit_us;
  if (any && touches_.tared() && (all_heard() || over))
    state_ = State::kDone;
  else if (over)
    state_ = any ? State::kIncomplete : State::kNoSample;
  return state_;
}

}  // namespace triskin::skin
