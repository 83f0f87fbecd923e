// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/wire/can_frame.hpp"
#include "triskin/wire/taxel_frames.hpp"

/// How long frames occupy a wire: the one owner of frame lengths, for the simulated bus and for every budget.
namespace triskin::wire {

/// Length of a frame on the bus, bits.
struct FrameBits {
  int nominal = 0;  ///< So many bits are sent at the nominal bit rate.
  int data = 0;     ///< So many bits are sent at the data bit rate.
};

/// Length of `frame` with the largest number of stuff bits that can occur (ISO 11898-1), interframe space included.
[[nodiscard]] constexpr FrameBits bits_of(const CanFrame& frame) {
  const int bytes = frame.size;
  if (!frame.fd) {
    // From start bit to CRC stuff bits may stand; delimiters, acknowledge, end and interframe space have none.
    const int stuffed = (frame.extended ? 54 : 34) + 8 * bytes;
    return {stuffed + (stuffed - 1) / 4 + 13, 0};
  }
  const int arbitration = frame.extended ? 36 : 17;
  const int crc = bytes > 16 ? 21 : 17;
  const int fixed_stuff = (crc + 4) / 4 + 1;  // One before the stuff count, then after every fourth bit.
  const int data = 6 + 8 * bytes + (6 + 8 * bytes) / 4 + 4 + crc + fixed_stuff;
  const int nominal = arbitration + arbitration / 4 + 13;
  return frame.bit_rate_switch ? FrameBits{nominal, data} : FrameBits{nominal + data, 0};
}

/// Bit rates of a CAN bus, bit/s.
struct BitRates {
  std::uint32_t nominal = 0;  ///< It is 0 where the rate is unknown or frames take no time.
  std::uint32_t data = 0;     ///< Frames with a rate switch use it; 0 means the nominal rate.
  bool operator==(const BitRates&) const = default;
};
/// What the controllers use on a real bus.
inline constexpr BitRates kControllerRates{1'000'000, 2'000'000};

/// Time that a frame occupies the bus at most, ns; 0 when the rates are not known.
[[nodiscard]] constexpr std::uint64_t frame_ns(const CanFrame& frame, const BitRates& rates) {
  if (rates.nominal == 0) return 0;
  const FrameBits bits = bits_of(frame);
  const std::uint64_t data_rate = rates.data != 0 ? rates.data : rates.nominal;
  return static_cast<std::uint64_t>(bits.nominal) * 1'000'000'000 / rates.nominal +
         static_cast<std::uint64_t>(bits.data) * 1'000'000'000 / data_rate;
}

/// USB full speed: 19 bulk packets a millisecond, and each frame of the full stream nearly fills one; one HID report a
/// millisecond (docs/protocol.md, "USB").
inline constexpr std::uint64_t kUsbBulkFrame_ns = 1'000'000 / 19, kUsbHidFrame_ns = 1'000'000;

/// Part of a wire, 1 = all of it, that the samples of a stream may take. The rest is for requests, answers and errors.
inline constexpr double kStreamShare = 0.90;

/// What one module's sample takes of a bus as its frame of the full stream, ns; 0 when the rates are not known.
[[nodiscard]] constexpr std::uint64_t full_sample_ns(const BitRates& rates) {
  return frame_ns(encode_full({.node_address = 1}), rates);
}
/// The same as its two frames of the iCub stream, ns.
[[nodiscard]] constexpr std::uint64_t icub_sample_ns(const BitRates& rates) {
  const auto frames = encode_icub({});
  return frame_ns(frames[0], rates) + frame_ns(frames[1], rates);
}

/// Load of a wire as a fraction of it, by `modules` samples of `sample_ns` each in every `interval_us`; 0 without
/// interval.
[[nodiscard]] constexpr double stream_load(std::size_t modules, std::uint64_t sample_ns, std::uint64_t interval_us) {
  if (interval_us == 0) return 0.0;
  return static_cast<double>(modules) * static_cast<double>(sample_ns) / (1000.0 * static_cast<double>(interval_us));
}

}  // namespace triskin::wire
