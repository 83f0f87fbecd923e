// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "triskin/layout/patch_image.hpp"
#include "triskin/wire/can_frame.hpp"

namespace triskin::fw {

/// Frames of the iCub stream that wait for room in a port, first in, first out. What finds no room is dropped and
/// counted: the bus is slower than the stream.
class StreamQueue {
 public:
  static constexpr std::size_t kCapacity = 3 * layout::kMaxModules - 1;  ///< frames; a sample takes one or two

  /// Takes frames that belong together: all, or none when there is no room for all. Result: whether they were taken.
  bool push(std::span<const wire::CanFrame> frames);
  /// True when no frame waits.
  [[nodiscard]] bool empty() const { return size_ == 0; }
  /// Frames that wait.
  [[nodiscard]] std::size_t size() const { return size_; }
  /// The frame that waits longest; the queue must not be empty.
  [[nodiscard]] const wire::CanFrame& front() const { return frames_[first_]; }
  /// Takes front() out, which was sent.
  void pop();
  /// Takes all out unsent: they are not counted as dropped.
  void clear() { size_ = 0; }
  /// Frames that found no room since power-up.
  [[nodiscard]] std::uint32_t dropped() const { return dropped_; }

 private:
  std::array<wire::CanFrame, kCapacity> frames_{};  // Used as a ring.
  std::size_t first_ = 0, size_ = 0;
  std::uint32_t dropped_ = 0;
};

}  // namespace triskin::fw
