// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "triskin/core/bytes.hpp"
#include "triskin/core/status.hpp"
#include "triskin/wire/can_frame.hpp"

namespace triskin::wire {

/// An object is one ISO 15765-2 connection between two addresses, in both directions, on classic CAN or CAN FD. It is a
/// pure state machine without heap: the caller provides received frames and the time and sends the frames that it
/// returns. Messages have up to kCapacity bytes. Not thread-safe.
class IsoTp {
 public:
  static constexpr std::size_t kCapacity = 1024;
  static constexpr std::uint8_t kPadding = 0xCC;
  static constexpr std::uint64_t kTimeout_us = 1'000'000;  ///< ISO 15765-2 sets this value for N_Bs and N_Cr.
  static constexpr int kMaxWaits = 10;  ///< The sender gives up after this many flow controls "wait" in a row.

  enum class Event : std::uint8_t { kNone, kReceived, kSent, kFailed };

  /// `frame_bytes` is the longest frame to send: 8 on classic CAN, 64 with FD.
  constexpr IsoTp(std::uint32_t tx_id, std::uint32_t rx_id, std::uint8_t frame_bytes)
      : tx_id_(tx_id), rx_id_(rx_id), frame_bytes_(frame_bytes) {}

  /// Returns the identifier of the frames that this connection receives.
  [[nodiscard]] constexpr std::uint32_t rx_id() const { return rx_id_; }
  /// Sets the longest frame from now on, because a server answers in the frame format of the request. Ignored while
  /// sending.
  constexpr void set_frame_bytes(std::uint8_t frame_bytes) {
    if (!sending()) frame_bytes_ = frame_bytes;
  }
  /// Returns true while a message is being sent.
  [[nodiscard]] constexpr bool sending() const { return tx_ != Tx::kIdle; }
  /// Returns the last complete message; it is valid until the next frame is received.
  [[nodiscard]] constexpr Bytes message() const { return {rx_buffer_.data(), rx_size_}; }

  /// Starts to send a message. Errors: kNoSpace (empty or longer than kCapacity), kOutOfRange (still sending).
  constexpr Status send(Bytes message, std::uint64_t now_us) {
    if (message.empty() || message.size() > kCapacity) return Status::kNoSpace;
    if (sending()) return Status::kOutOfRange;
    std::copy(message.begin(), message.end(), tx_buffer_.begin());
    tx_size_ = message.size();
    tx_at_ = 0;
    tx_ = Tx::kFirst;
    tx_deadline_us_ = now_us + kTimeout_us;
    return Status::kOk;
  }

  /// Handles a frame with identifier rx_id(). Frames that make no sense in this state are ignored, as the standard
  /// demands.
  constexpr Event receive(const CanFrame& frame, std::uint64_t now_us) {
    if (frame.size < 1) return Event::kNone;
    switch (frame.data[0] >> 4) {
      case 0:
        return receive_single(frame);
      case 1:
        return receive_first(frame, now_us);
      case 2:
        return receive_consecutive(frame, now_us);
      case 3:
        return receive_flow_control(frame, now_us);
      default:
        return Event::kNone;
    }
  }

  /// Returns the next frame to send now. Call it until the result is empty.
  constexpr std::optional<CanFrame> transmit(std::uint64_t now_us) {
    if (flow_control_due_) {
      flow_control_due_ = false;
      return make_frame(std::array<std::uint8_t, 3>{flow_status_, 0, 0});
    }
    if (tx_ == Tx::kFirst) return transmit_first(now_us);
    if (tx_ == Tx::kConsecutive && now_us >= tx_next_us_) return transmit_consecutive(now_us);
    return std::nullopt;
  }

  /// Ends a transfer that has timed out.
  constexpr Event tick(std::uint64_t now_us) {
    if (rx_expected_ > 0 && now_us > rx_deadline_us_) {
      rx_expected_ = 0;
      return Event::kFailed;
    }
    if (tx_ == Tx::kWaitFlowControl && now_us > tx_deadline_us_) {
      tx_ = Tx::kIdle;
      return Event::kFailed;
    }
    return Event::kNone;
  }

  /// Returns the time of the next frame or timeout, or the largest value when nothing is in progress.
  [[nodiscard]] constexpr std::uint64_t next_event_us() const {
    if (flow_control_due_ || tx_ == Tx::kFirst) return 0;
    std::uint64_t next = UINT64_MAX;
    if (tx_ == Tx::kConsecutive) next = tx_next_us_;
    if (tx_ == Tx::kWaitFlowControl) next = tx_deadline_us_ + 1;
    if (rx_expected_ > 0) next = std::min(next, rx_deadline_us_ + 1);
    return next;
  }

 private:
  enum class Tx : std::uint8_t { kIdle, kFirst, kWaitFlowControl, kConsecutive };

  constexpr CanFrame make_frame(Bytes bytes) const {
    CanFrame f;
    f.id = tx_id_;
    f.extended = true;
    f.fd = f.bit_rate_switch = frame_bytes_ > 8;
    // Above 8 bytes, CAN FD only has lengths 12, 16, 20, 24, 32, 48 and 64; all frames are padded to at least 8.
    f.size = 8;
    for (const std::uint8_t length : std::array<std::uint8_t, 7>{12, 16, 20, 24, 32, 48, 64}) {
      if (bytes.size() > f.size) f.size = length;
    }
    std::copy(bytes.begin(), bytes.end(), f.data.begin());
    std::fill(f.data.begin() + static_cast<std::ptrdiff_t>(bytes.size()), f.data.begin() + f.size, kPadding);
    return f;
  }

  constexpr Event receive_single(const CanFrame& frame) {
    const std::uint8_t low = frame.data[0] & 0xF;
    const bool escape = low == 0 && frame.size > 8;  // A long FD frame stores its length in the next byte.
    const std::size_t size = escape ? frame.data[1] : low, start = escape ? 2 : 1;
    if (size == 0 || start + size > frame.size) return Event::kNone;
    rx_expected_ = 0;
    rx_size_ = size;
    std::copy_n(frame.data.begin() + static_cast<std::ptrdiff_t>(start), size, rx_buffer_.begin());
    return Event::kReceived;
  }

  constexpr Event receive_first(const CanFrame& frame, std::uint64_t now_us) {
    if (frame.size < 8) return Event::kNone;
    std::size_t size = static_cast<std::size_t>(frame.data[0] & 0xF) << 8 | frame.data[1], start = 2;
    if (size == 0) {  // The message is longer than 4,095 bytes, so its size follows in four bytes.
      size = static_cast<std::size_t>(frame.data[2]) << 24 | static_cast<std::size_t>(frame.data[3]) << 16 |
             static_cast<std::size_t>(frame.data[4]) << 8 | frame.data[5];
      start = 6;
    }
    // A message of this size fits into a single frame and may not start with a first frame.
    if (size < 8 || size <= frame.size - start) return Event::kNone;
    flow_control_due_ = true;
    if (size > kCapacity) {
      flow_status_ = 0x32;  // The receiver reports an overflow, so the sender gives up.
      rx_expected_ = 0;
      return Event::kNone;
    }
    flow_status_ = 0x30;
    rx_expected_ = size;
    rx_frame_bytes_ = frame.size;
    rx_at_ = frame.size - start;
    std::copy_n(frame.data.begin() + static_cast<std::ptrdiff_t>(start), rx_at_, rx_buffer_.begin());
    rx_sequence_ = 1;
    rx_deadline_us_ = now_us + kTimeout_us;
    return Event::kNone;
  }

  constexpr Event receive_consecutive(const CanFrame& frame, std::uint64_t now_us) {
    if (rx_expected_ == 0) return Event::kNone;
    if ((frame.data[0] & 0xF) != rx_sequence_) {  // A frame was lost or overtaken, so the message is given up.
      rx_expected_ = 0;
      return Event::kFailed;
    }
    // Only the last frame may be shorter than the first one, and it must contain all missing bytes.
    const std::size_t n = std::min<std::size_t>(rx_frame_bytes_ - 1U, rx_expected_ - rx_at_);
    if (frame.size < n + 1) {
      rx_expected_ = 0;
      return Event::kFailed;
    }
    rx_sequence_ = (rx_sequence_ + 1) & 0xF;
    std::copy_n(frame.data.begin() + 1, n, rx_buffer_.begin() + static_cast<std::ptrdiff_t>(rx_at_));
    rx_at_ += n;
    rx_deadline_us_ = now_us + kTimeout_us;
    if (rx_at_ < rx_expected_) return Event::kNone;
    rx_size_ = rx_expected_;
    rx_expected_ = 0;
    return Event::kReceived;
  }

  constexpr Event receive_flow_control(const CanFrame& frame, std::uint64_t now_us) {
    if (tx_ != Tx::kWaitFlowControl || frame.size < 3) return Event::kNone;
    switch (frame.data[0] & 0xF) {
      case 0:
        tx_ = Tx::kConsecutive;
        tx_block_left_ = frame.data[1];
        tx_blocks_ = frame.data[1] != 0;
        tx_gap_us_ = gap_us(frame.data[2]);
        tx_next_us_ = now_us;
        tx_waits_ = 0;
        return Event::kNone;
      case 1:
        tx_deadline_us_ = now_us + kTimeout_us;
        if (++tx_waits_ <= kMaxWaits) return Event::kNone;
        [[fallthrough]];
      default:
        tx_ = Tx::kIdle;
        return Event::kFailed;
    }
  }

  // STmin is 0–127 ms, or 0xF1–0xF9 for 100–900 µs; the standard maps reserved values to the longest time.
  static constexpr std::uint64_t gap_us(std::uint8_t st_min) {
    if (st_min <= 0x7F) return st_min * 1000ULL;
    if (st_min >= 0xF1 && st_min <= 0xF9) return (st_min - 0xF0) * 100ULL;
    return 127'000;
  }

  constexpr CanFrame transmit_first(std::uint64_t now_us) {
    std::array<std::uint8_t, 64> bytes{};
    if (tx_size_ <= 7) {
      bytes[0] = static_cast<std::uint8_t>(tx_size_);
      std::copy_n(tx_buffer_.begin(), tx_size_, bytes.begin() + 1);
      tx_ = Tx::kIdle;
      return make_frame(Bytes(bytes).first(tx_size_ + 1));
    }
    if (tx_size_ + 2 <= frame_bytes_) {
      bytes[1] = static_cast<std::uint8_t>(tx_size_);
      std::copy_n(tx_buffer_.begin(), tx_size_, bytes.begin() + 2);
      tx_ = Tx::kIdle;
      return make_frame(Bytes(bytes).first(tx_size_ + 2));
    }
    bytes[0] = static_cast<std::uint8_t>(0x10 | tx_size_ >> 8);
    bytes[1] = static_cast<std::uint8_t>(tx_size_);
    tx_at_ = frame_bytes_ - 2U;
    std::copy_n(tx_buffer_.begin(), tx_at_, bytes.begin() + 2);
    tx_ = Tx::kWaitFlowControl;
    tx_sequence_ = 1;
    tx_deadline_us_ = now_us + kTimeout_us;
    return make_frame(Bytes(bytes).first(frame_bytes_));
  }

  constexpr CanFrame transmit_consecutive(std::uint64_t now_us) {
    std::array<std::uint8_t, 64> bytes{};
    bytes[0] = static_cast<std::uint8_t>(0x20 | tx_sequence_);
    tx_sequence_ = (tx_sequence_ + 1) & 0xF;
    const std::size_t n = std::min<std::size_t>(frame_bytes_ - 1U, tx_size_ - tx_at_);
    std::copy_n(tx_buffer_.begin() + static_cast<std::ptrdiff_t>(tx_at_), n, bytes.begin() + 1);
    tx_at_ += n;
    tx_next_us_ = now_us + tx_gap_us_;
    if (tx_at_ == tx_size_) {
      tx_ = Tx::kIdle;
    } else if (tx_blocks_ && --tx_block_left_ == 0) {
      tx_ = Tx::kWaitFlowControl;
      tx_deadline_us_ = now_us + kTimeout_us;
    }
    return make_frame(Bytes(bytes).first(n + 1));
  }

  std::uint32_t tx_id_, rx_id_;
  std::uint8_t frame_bytes_, rx_frame_bytes_ = 8;
  Tx tx_ = Tx::kIdle;
  std::array<std::uint8_t, kCapacity> tx_buffer_{}, rx_buffer_{};
  std::size_t tx_size_ = 0, tx_at_ = 0, rx_size_ = 0, rx_at_ = 0, rx_expected_ = 0;
  std::uint8_t tx_sequence_ = 0, rx_sequence_ = 0, tx_block_left_ = 0, flow_status_ = 0x30;
  bool tx_blocks_ = false, flow_control_due_ = false;
  int tx_waits_ = 0;
  std::uint64_t tx_gap_us_ = 0, tx_next_us_ = 0, tx_deadline_us_ = 0, rx_deadline_us_ = 0;
};

}  // namespace triskin::wire
