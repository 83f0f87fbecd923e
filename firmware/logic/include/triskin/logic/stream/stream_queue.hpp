// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "triskin/layout/patch_image.hpp"
#include "triskin/wire/can_frame.hpp"

namespace triskin::fw {

/// Frames of the iCub stream wait here for room in a port, first in, first out. Frames without room are dropped and
/// counted, because the bus is slower than the stream.
class StreamQueue {
 public:
  /// The capacity is in frames; a sample takes one or two.
  static constexpr std::size_t kCapacity = 3 * layout::kMaxModules - 1;

  /// Adds frames that belong together: all of them, or none if there is not enough room. Returns whether they were
  /// added.
  bool push(std::span<const wire::CanFrame> frames);
  /// Returns true when no frame waits.
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Returns the frame that has waited longest; the queue must not be empty.
  [[nodiscard]] const wire::CanFrame& front() const { return frames_[first_]; }
  /// Removes front() after it was sent.
  void pop();
  /// Removes all frames unsent, without counting them as dropped.
  void clear() { size_ = 0; }
  /// Counts the frames that found no room since power-up.
  [[nodiscard]] std::uint32_t dropped() const { return dropped_; }

 private:
  std::array<wire::CanFrame, kCapacity> frames_{};  // The array is used as a ring.
  std::size_t first_ = 0, size_ = 0;
  std::uint32_t dropped_ = 0;
};

}  // namespace triskin::fw
