// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "triskin/recording/messages.hpp"

namespace triskin::recording {

/// Groups arriving samples of one controller that have the same number into raw frames. Memory: one frame per
/// controller. Threads: one.
class RawFrames {
 public:
  using OnFrame = std::function<void(std::span<const ModuleSample>)>;
  /// The functions below call `handler`, with samples as encode_raw requires them.
  explicit RawFrames(OnFrame handler) : handler_(std::move(handler)) {}
  /// Adds a sample. A frame is complete when a sample with another number arrives, or a tenth of a second later.
  void add(const ModuleSample& sample);
  /// Passes on all incomplete frames.
  void flush() { pass_on(~std::uint64_t{0}); }

 private:
  void pass_on(std::uint64_t before_us);
  void pass_on(std::vector<ModuleSample>& frame);
  OnFrame handler_;
  // For each node, the map has the modules of its latest sample.
  std::map<std::uint8_t, std::vector<ModuleSample>> frames_;
  std::uint64_t next_sweep_us_ = 0;
};

}  // namespace triskin::recording
