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

namespace triskin::link {

/// Thrown when the connection to a controller is cut; work can continue after Link::reconnect succeeds.
class Unreachable : public DeviceError {
 public:
  using DeviceError::DeviceError;
};

/// Sends and receives whole messages to and from one address, with segmentation by the operating system (ISO 15765-2).
/// Use it in the thread of the link.
class MessageChannel {
 public:
  enum class Arrival {
    kNothing,  ///< No message has arrived yet.
    kMessage,  ///< A whole message has arrived.
    kFailed,   ///< A message was abandoned before it was complete, in either direction.
  };
  virtual ~MessageChannel() = default;
  /// Starts to send one message without waiting for its end. Returns false if it is refused, or if the last message is
  /// still being sent.
  [[nodiscard]] virtual bool send(Bytes message) = 0;
  /// Moves the next message into `message` (kMessage only; otherwise its contents are unspecified). Does not wait.
  [[nodiscard]] virtual Arrival take(std::vector<std::uint8_t>& message) = 0;
};

/// Transports frames to and from patch controllers over CAN, USB or the simulation. Only one thread may use it at a
/// time; a caller that passes the link to another thread must synchronize the two.
class Link {
 public:
  virtual ~Link() = default;
  /// Sends one frame of at most frame_bytes(). May wait while a queue is full. Throws Unreachable naming the link and
  /// the cause when the link is dead.
  virtual void send(const wire::CanFrame& frame) = 0;
  /// Waits for a frame until `until_us` of the link's clock (a time in the past means no waiting). An empty result
  /// means that none arrived or that a message channel has data; it can come before `until_us`. Throws as send does.
  virtual std::optional<wire::CanFrame> receive(std::uint64_t until_us) = 0;
  /// Returns the time of the link in µs. It is monotonic, and virtual in the in-process simulation, where waiting
  /// costs nothing.
  [[nodiscard]] virtual std::uint64_t now_us() const = 0;
  /// Returns true if FD frames may be sent.
  [[nodiscard]] virtual bool fd() const = 0;
  /// Returns the longest frame that may be sent, 8 … 64 bytes.
  [[nodiscard]] virtual std::uint8_t frame_bytes() const { return fd() ? 64 : 8; }
  /// Returns the longest time in µs until a controller begins to answer: P2 of the protocol plus the delay of the
  /// link.
  [[nodiscard]] virtual std::uint64_t answer_us() const = 0;
  /// Returns the name for messages, in the syntax of `--link`.
  [[nodiscard]] virtual std::string name() const = 0;
  /// Describes problems of the link (bus errors, unplugged devices) in one sentence with the remedy; empty if there are
  /// none.
  [[nodiscard]] virtual std::string trouble() const { return {}; }
  /// Returns the end of a sentence that tells the user what to check when no device answers.
  [[nodiscard]] virtual std::string when_silent() const { return "check power, cable and bit rate"; }
  /// From now on receive() also returns what other hosts send, where the link can hear it: on a CAN bus. Throws as send
  /// does.
  virtual void receive_from_all() {}
  /// Opens a connection on which the operating system segments messages; the link must outlive it. `tx_id` and `rx_id`
  /// are 29-bit identifiers. Null means that the link has none, and the caller must segment messages itself. Throws
  /// DeviceError when it cannot be opened.
  [[nodiscard]] virtual std::unique_ptr<MessageChannel> open_channel(std::uint32_t tx_id, std::uint32_t rx_id) {
    (void)tx_id, (void)rx_id;
    return nullptr;
  }
  /// Returns the number of the wire that leads to node address `node`. Controllers on one CAN bus share a wire; each
  /// USB device has its own. 0 while it is not known.
  [[nodiscard]] virtual int wire_of(std::uint8_t node) const {
    (void)node;
    return 0;
  }
  /// Returns the longest time in ns for which one sample of the full stream of controller `node` occupies its wire; 0
  /// if it is not known or takes none.
  [[nodiscard]] virtual std::uint64_t sample_ns(std::uint8_t node) const {
    (void)node;
    return 0;
  }
  /// Counts the received frames that this computer discarded since the link was opened, because no one took them in
  /// time.
  [[nodiscard]] virtual std::uint64_t thrown_away() const { return 0; }
  /// Returns the links that this one joins, which live as long as it does; empty if it is a single link. Each may be
  /// used by another thread while nobody uses the whole.
  [[nodiscard]] virtual std::vector<Link*> parts() { return {}; }
  /// Restores a link that was cut; it has no effect on one that works. Throws DeviceError when it stays cut.
  virtual void reconnect() {}
};

}  // namespace triskin::link
