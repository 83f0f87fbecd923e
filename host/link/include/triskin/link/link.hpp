// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "triskin/base/error.hpp"
#include "triskin/core/bytes.hpp"
#include "triskin/wire/can_frame.hpp"

namespace triskin::device {

/// The connection to a controller is cut; the work can go on after Link::reconnect succeeds.
class Unreachable : public DeviceError {
 public:
  using DeviceError::DeviceError;
};

/// Whole messages to and from one address, where the operating system segments them (ISO 15765-2). Threads: that of the
/// link.
class MessageChannel {
 public:
  enum class Arrival {
    kNothing,  ///< No message has come yet.
    kMessage,  ///< A whole message has come.
    kFailed,   ///< A message was abandoned on the way, in either direction.
  };
  virtual ~MessageChannel() = default;
  /// Starts to send one message and does not wait for the end. False: refused, or the last message is still under
  /// way.
  [[nodiscard]] virtual bool send(Bytes message) = 0;
  /// Takes the next message into `message` (kMessage only; otherwise its contents are unspecified). Does not wait.
  [[nodiscard]] virtual Arrival take(std::vector<std::uint8_t>& message) = 0;
};

/// Frames to and from patch controllers over CAN, USB or the simulation. Threads: one at a time; a caller that passes
/// the link to another thread synchronizes the two.
class Link {
 public:
  virtual ~Link() = default;
  /// Sends one frame of at most frame_bytes(). May wait while a queue is full. Throws Unreachable naming the link and
  /// the cause when the link is dead.
  virtual void send(const wire::CanFrame& frame) = 0;
  /// Waits for a frame until `until_us` of the link's clock (a time in the past: does not wait). Empty: none came, or a
  /// message channel has something, which may be before `until_us`. Throws as send does.
  virtual std::optional<wire::CanFrame> receive(std::uint64_t until_us) = 0;
  /// Time of the link, µs: monotonic; virtual in the in-process simulation, where waiting costs nothing.
  [[nodiscard]] virtual std::uint64_t now_us() const = 0;
  /// True: FD frames may be sent.
  [[nodiscard]] virtual bool fd() const = 0;
  /// Longest frame that may be sent, bytes: 8 … 64.
  [[nodiscard]] virtual std::uint8_t frame_bytes() const { return fd() ? 64 : 8; }
  /// Longest time until the first answer of a controller, µs: P2 of the protocol plus the delay of the link.
  [[nodiscard]] virtual std::uint64_t answer_us() const = 0;
  /// Name for messages, as `--link` has it.
  [[nodiscard]] virtual std::string name() const = 0;
  /// One sentence on what the link has noticed (bus errors, unplugged devices) and the remedy; empty: nothing.
  [[nodiscard]] virtual std::string trouble() const { return {}; }
  /// What to look at when nobody answers, as the end of a sentence.
  [[nodiscard]] virtual std::string when_silent() const { return "check power, cable and bit rate"; }
  /// From now on receive() also returns what other hosts send, where the link can hear it: on a CAN bus. Throws as send
  /// does.
  virtual void receive_from_all() {}
  /// A connection on which the operating system segments messages; the link outlives it. `tx_id`, `rx_id`: 29-bit
  /// identifiers. Null: the link has none, and the caller segments itself. Throws DeviceError when it cannot be opened.
  [[nodiscard]] virtual std::unique_ptr<MessageChannel> open_channel(std::uint32_t tx_id, std::uint32_t rx_id) {
    (void)tx_id, (void)rx_id;
    return nullptr;
  }
  /// Number of the wire that leads to node address `node`: controllers on one CAN bus share one, each USB device has
  /// its own. 0 while it is not known.
  [[nodiscard]] virtual int wire_of(std::uint8_t node) const {
    (void)node;
    return 0;
  }
  /// Longest time that one sample of the full stream of controller `node` occupies its wire, ns; 0: not known, or none.
  [[nodiscard]] virtual std::uint64_t sample_ns(std::uint8_t node) const {
    (void)node;
    return 0;
  }
  /// Frames that came and that this computer threw away since the link was opened, because nobody took them in time.
  [[nodiscard]] virtual std::uint64_t thrown_away() const { return 0; }
  /// The links that this one joins, which live as long as it; empty: it is one. Each may be used by another thread
  /// while nobody uses the whole.
  [[nodiscard]] virtual std::vector<Link*> parts() { return {}; }
  /// Restores a link that was cut; without effect on one that works. Throws DeviceError when it stays cut.
  virtual void reconnect() {}
};

}  // namespace triskin::device
