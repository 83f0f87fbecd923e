// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/view/latest_samples.hpp"

namespace triskin::view {

/// Converts the samples of a recording into the frames that a page plays, equal to those of the WebSocket, each
/// preceded by its length, and the contacts between them. Memory and result are bounded: where a recording would exceed
/// `max_bytes`, later frames are dropped and is_cut() returns true.
class FrameTrack {
 public:
  /// Two frames are kStep_us apart. The other constants limit what a page may hold.
  static constexpr std::int64_t kStep_us = 33'000;
  static constexpr std::size_t kMax_bytes = 64U << 20U, kMaxInFile_bytes = 16U << 20U;

  /// Returns the contacts of the samples that were added so far.
  using ContactSource = std::function<std::vector<LatestSamples::Contact>()>;

  /// `modules` is the number of modules of the design; `max_bytes` limits the result, > 0. `contacts` is asked behind a
  /// frame, at most every LatestSamples::kContactsEvery of the recording; without it the track has no contacts.
  FrameTrack(std::size_t modules, std::size_t max_bytes, ContactSource contacts = {})
      : live_(modules), max_bytes_(max_bytes), contacts_(std::move(contacts)) {}

  /// Ends the frame that is complete before `time_us`. Whoever keeps state for `contacts` calls it before taking a
  /// sample of that time into the state; add() calls it too.
  void advance_to(std::int64_t time_us);
  /// Adds a sample. `time_us` is the clock of the recording and must not decrease between calls, except for samples of
  /// other controllers at the same instant. A module that the design lacks is ignored.
  void add(layout::SkinModule module, const PressureSample& sample, std::int64_t time_us);

  /// Returns the track: for each frame and list of contacts its length (4 bytes, little-endian) and its bytes as in
  /// docs/view.md, with times in ms since the first sample. Empty without samples. Call it once, at the end.
  [[nodiscard]] std::string finish();
  /// Returns true when frames were dropped because the track had reached its limit.
  [[nodiscard]] bool is_cut() const { return is_cut_; }

 private:
  void flush();
  void flush_contacts(std::int64_t frame_us);
  void append(std::string_view entry);

  LatestSamples live_;
  std::size_t max_bytes_;
  ContactSource contacts_;
  std::string bytes_;
  std::uint64_t seen_ = 0, seen_contacts_ = 0;
  std::int64_t start_us_ = 0, due_us_ = 0, newest_us_ = 0, contacts_due_us_ = 0;
  bool started_ = false, is_cut_ = false;
};

}  // namespace triskin::view
