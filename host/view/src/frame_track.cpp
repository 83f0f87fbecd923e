// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/view/frame_track.hpp"

namespace triskin::view {

void FrameTrack::add(layout::SkinModule module, const PressureSample& sample, std::int64_t time_us) {
  if (!started_) {
    start_us_ = time_us;
    due_us_ = time_us + kStep_us;
    started_ = true;
  }
  if (time_us >= due_us_) {
    flush();
    due_us_ = time_us + kStep_us;
  }
  live_.add(module, sample, time_us - start_us_);
}

void FrameTrack::flush() {
  const std::string frame = live_.frame_since(seen_);
  if (frame.empty()) return;
  if (bytes_.size() + frame.size() + 4 > max_bytes_) {
    is_cut_ = true;
    return;
  }
  for (int k = 0; k < 4; ++k) bytes_ += static_cast<char>(frame.size() >> 8 * k & 0xFF);
  bytes_ += frame;
}

std::string FrameTrack::finish() {
  flush();
  return std::move(bytes_);
}

}  // namespace triskin::view
