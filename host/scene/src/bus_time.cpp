// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/scene/bus_time.hpp"

namespace triskin::scene {

FrameBits bits_of(const wire::CanFrame& frame) {
  const int bytes = frame.size;
  if (!frame.fd) {
    // From start bit to CRC stuff bits may stand; delimiters, acknowledge, end and interframe space have none.
    const int stuffed = (frame.extended ? 54 : 34) + 8 * bytes;
    return {stuffed + (stuffed - 1) / 4 + 13, 0};
  }
  const int arbitration = frame.extended ? 36 : 17;
  const int crc = bytes > 16 ? 21 : 17;
  const int fixed_stuff = (crc + 4) / 4 + 1;  // one before the stuff count, then after every fourth bit
  const int data = 6 + 8 * bytes + (6 + 8 * bytes) / 4 + 4 + crc + fixed_stuff;
  const int nominal = arbitration + arbitration / 4 + 13;
  return frame.bit_rate_switch ? FrameBits{nominal, data} : FrameBits{nominal + data, 0};
}

}  // namespace triskin::scene
