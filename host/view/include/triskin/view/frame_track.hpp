// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

#include "triskin/view/live_skin.hpp"

namespace triskin::view {

/// Turns the samples of a recording into the frames that a page plays: the same frames as those of the WebSocket, each
/// behind its length. Memory and the result are bounded: where a recording would exceed `max_bytes`, later frames
/// are dropped and is_cut() says so.
class FrameTrack {
 public:
  /// Time between two frames, µs; and how much a page may hold, bytes.
  static constexpr std::int64_t kStep_us = 33'000;
  static constexpr std::size_t kMax_bytes = 64U << 20U, kMaxInFile_bytes = 16U << 20U;

  /// `modules`: number of modules of the design. `max_bytes`: of the result, > 0.
  FrameTrack(std::size_t modules, std::size_t max_bytes) : live_(modules), max_bytes_(max_bytes) {}

  /// Takes a sample; `time_us` is the clock of the recording and does not fall from one call to the next, but for
  /// samples of other controllers of the same instant. A module that the design lacks is ignored.
  void add(int module, const PressureSample& sample, std::int64_t time_us);

  /// The track: for each frame its length (4 bytes, little-endian) and its bytes as docs/view_server.md has them, times
  /// in ms since the first sample. Empty without samples. Call it once, at the end.
  [[nodiscard]] std::string finish();
  /// True when frames were dropped because the track had reached its limit.
  [[nodiscard]] bool is_cut() const { return is_cut_; }

 private:
  void flush();

  LiveSkin live_;
  std::size_t max_bytes_;
  std::string bytes_;
  std::uint64_t seen_ = 0;
  std::int64_t start_us_ = 0, due_us_ = 0;
  bool started_ = false, is_cut_ = false;
};

}  // namespace triskin::view
