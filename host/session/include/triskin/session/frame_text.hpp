// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "triskin/wire/can_frame.hpp"

namespace triskin::device {

/// A frame as candump prints it: identifier, number of bytes, bytes in hexadecimal. FD frames have their length in
/// double brackets. Cost: linear in the bytes.
[[nodiscard]] std::string bytes_text(const wire::CanFrame& frame);

/// Says what each frame of a bus means (docs/protocol.md): who sends to whom, which request or answer, which sample.
/// Messages of several frames are joined, and named when they are whole. Frames are given in the order of the bus.
/// Threads: one.
class FrameReader {
 public:
  /// What the frame means; "not of Triskin" for foreign identifiers. Frames that are damaged are called so; nothing is
  /// thrown.
  [[nodiscard]] std::string text(const wire::CanFrame& frame);

 private:
  struct Message {
    std::vector<std::uint8_t> bytes;
    std::size_t size = 0;  // Length that its first frame announced.
  };
  [[nodiscard]] std::string segment(const wire::CanFrame& frame);
  [[nodiscard]] std::string first_segment(const wire::CanFrame& frame);
  [[nodiscard]] std::string next_segment(const wire::CanFrame& frame);

  std::map<std::uint32_t, Message> messages_;  // By identifier.
};

}  // namespace triskin::device
