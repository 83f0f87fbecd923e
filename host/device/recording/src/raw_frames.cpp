// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/recording/raw_frames.hpp"

#include <algorithm>

namespace triskin::recording {
namespace {

// Modules of one sample arrive within a few ms, so a frame that is older than this is complete.
constexpr std::uint64_t kFrameSpan_us = 100'000;

}  // namespace

void RawFrames::pass_on(std::vector<ModuleSample>& frame) {
  if (frame.empty()) return;
  handler_(frame);
  frame.clear();
}

// Passes on the frames whose first module arrived before `before_us`.
void RawFrames::pass_on(std::uint64_t before_us) {
  for (auto& [node, frame] : frames_) {
    if (!frame.empty() && frame.front().link_time_us < before_us) pass_on(frame);
  }
}

void RawFrames::add(const ModuleSample& sample) {
  auto& frame = frames_[sample.sample.node_address];
  if (!frame.empty()) {
    const ModuleSample& first = frame.front();
    const bool fits =
        first.sample.sample == sample.sample.sample && sample.link_time_us - first.link_time_us < kFrameSpan_us;
    if (!fits) pass_on(frame);
  }
  frame.push_back(sample);
  if (sample.link_time_us < next_sweep_us_) return;
  pass_on(sample.link_time_us - std::min(sample.link_time_us, kFrameSpan_us));
  next_sweep_us_ = sample.link_time_us + kFrameSpan_us;
}

}  // namespace triskin::recording
