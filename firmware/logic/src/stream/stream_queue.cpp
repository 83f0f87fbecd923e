// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/stream/stream_queue.hpp"

namespace triskin::fw {

bool StreamQueue::push(std::span<const wire::CanFrame> frames) {
  if (frames.size() > kCapacity - size_) {
    dropped_ += static_cast<std::uint32_t>(frames.size());
    return false;
  }
  for (const wire::CanFrame& frame : frames) frames_[(first_ + size_++) % kCapacity] = frame;
  return true;
}

void StreamQueue::pop() {
  first_ = (first_ + 1) % kCapacity;
  --size_;
}

}  // namespace triskin::fw
