// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/wire/can_frame.hpp"
#include "triskin/wire/taxel_frames.hpp"

/// Computes how long a frame occupies a wire. The simulated bus and every time budget use these functions.
namespace triskin::wire {

/// The length of a frame in bits is split by the bit rate that sends them.
struct FrameBits {
  int nominal = 0;
  int data = 0;
};

/// Returns the length of `frame` with the most stuff bits that can occur (ISO 11898-1) and the interframe space.
[[nodiscard]] constexpr FrameBits bits_of(const CanFrame& frame) {
  const int bytes = frame.size;
  if (!frame.fd) {
    // Stuff bits can occur from the start bit to the CRC; delimiters, acknowledge, end and interframe space have none.
    const int stuffed = (frame.extended ? 54 : 34) + 8 * bytes;
    return {stuffed + (stuffed - 1) / 4 + 13, 0};
  }
  const int arbitration = frame.extended ? 36 : 17;
  const int crc = bytes > 16 ? 21 : 17;
  // One fixed stuff bit precedes the stuff count, and one follows every fourth bit.
  const int fixed_stuff = (crc + 4) / 4 + 1;
  const int data = 6 + 8 * bytes + (6 + 8 * bytes) / 4 + 4 + crc + fixed_stuff;
  const int nominal = arbitration + arbitration / 4 + 13;
  return frame.bit_rate_switch ? FrameBits{nominal, data} : FrameBits{nominal + data, 0};
}

/// A CAN bus has two bit rates, in bit/s.
struct BitRates {
  std::uint32_t nominal = 0;  ///< Zero means that the rate is unknown or that frames take no time.
  std::uint32_t data = 0;     ///< Frames with a rate switch use this rate; 0 means the nominal rate.
  bool operator==(const BitRates&) const = default;
};
/// Real buses run at these rates.
inline constexpr BitRates kControllerRates{1'000'000, 2'000'000};

/// Returns the longest time in ns that a frame can occupy the bus; 0 when the rates are not known.
[[nodiscard]] constexpr std::uint64_t frame_ns(const CanFrame& frame, const BitRates& rates) {
  if (rates.nominal == 0) return 0;
  const FrameBits bits = bits_of(frame);
  const std::uint64_t data_rate = rates.data != 0 ? rates.data : rates.nominal;
  return static_cast<std::uint64_t>(bits.nominal) * 1'000'000'000 / rates.nominal +
         static_cast<std::uint64_t>(bits.data) * 1'000'000'000 / data_rate;
}

/// USB full speed carries 19 bulk packets per millisecond, each nearly filled by one frame of the full stream, or one
/// HID report per millisecond (docs/protocol.md, "USB").
inline constexpr std::uint64_t kUsbBulkFrame_ns = 1'000'000 / 19, kUsbHidFrame_ns = 1'000'000;

/// The samples of a stream may take this fraction of a wire's capacity. Requests, answers and errors need the rest.
inline constexpr double kStreamShare = 0.90;

/// Returns the bus time in ns of one module's sample in the full stream; 0 when the rates are not known.
[[nodiscard]] constexpr std::uint64_t full_sample_ns(const BitRates& rates) {
  return frame_ns(encode_full({.node_address = 1}), rates);
}
/// Returns the bus time in ns of the two frames that carry one module's sample in the iCub stream.
[[nodiscard]] constexpr std::uint64_t icub_sample_ns(const BitRates& rates) {
  const auto frames = encode_icub({});
  return frame_ns(frames[0], rates) + frame_ns(frames[1], rates);
}

/// Returns the load of a wire as a fraction of its capacity when `modules` samples of `sample_ns` each are sent every
/// `interval_us`; 0 without an interval.
[[nodiscard]] constexpr double stream_load(std::size_t modules, std::uint64_t sample_ns, std::uint64_t interval_us) {
  if (interval_us == 0) return 0.0;
  return static_cast<double>(modules) * static_cast<double>(sample_ns) / (1000.0 * static_cast<double>(interval_us));
}

}  // namespace triskin::wire
