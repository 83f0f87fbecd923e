// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "triskin/wire/can_frame.hpp"

namespace triskin::session {

/// Formats a frame like candump: identifier, number of bytes, bytes in hexadecimal. FD frames have their length in
/// double brackets. Cost: linear in the bytes.
[[nodiscard]] std::string bytes_text(const wire::CanFrame& frame);

/// Explains each frame of a bus (docs/protocol.md): who sends to whom, and which request, answer or sample it is.
/// Messages of several frames are joined and named when they are complete. Pass the frames in the order of the bus.
/// Threads: one.
class FrameReader {
 public:
  /// Returns the meaning of the frame, or "not of Triskin" for foreign identifiers. Damaged frames are described as
  /// damaged; nothing is thrown.
  [[nodiscard]] std::string text(const wire::CanFrame& frame);

 private:
  struct Message {
    std::vector<std::uint8_t> bytes;
    std::size_t size = 0;  // The first frame of the message announced this length.
  };
  [[nodiscard]] std::string segment(const wire::CanFrame& frame);
  [[nodiscard]] std::string first_segment(const wire::CanFrame& frame);
  [[nodiscard]] std::string next_segment(const wire::CanFrame& frame);

  std::map<std::uint32_t, Message> messages_;  // Messages are kept by the identifier of their frames.
};

}  // namespace triskin::session
