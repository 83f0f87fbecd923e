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

/// Gathers the samples of the modules of one controller that have one number into raw frames, as they come. Memory: one
/// frame a controller. Threads: one.
class RawFrames {
 public:
  using OnFrame = std::function<void(std::span<const ModuleSample>)>;
  /// `handler` is called inside the functions below, with samples as encode_raw wants them.
  explicit RawFrames(OnFrame handler) : handler_(std::move(handler)) {}
  /// Takes a sample. A frame is whole when one with another number comes, or a tenth of a second later.
  void add(const ModuleSample& sample);
  /// Passes on everything that waits.
  void flush() { pass_on(~std::uint64_t{0}); }

 private:
  void pass_on(std::uint64_t before_us);
  void pass_on(std::vector<ModuleSample>& frame);
  OnFrame handler_;
  std::map<std::uint8_t, std::vector<ModuleSample>> frames_;  // Keyed by node: modules of its latest sample.
  std::uint64_t next_sweep_us_ = 0;
};

}  // namespace triskin::recording
