// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "triskin/base/bytes.hpp"
#include "triskin/host/error.hpp"
#include "triskin/wire/can_frame.hpp"

namespace triskin::device {

/// A finger that the host can move: only simulated links have one.
class Finger {
 public:
  virtual ~Finger() = default;
  /// Presses a module at its centre, wide enough for all of its taxels, or one taxel (0..11) with the tip. Takes the
  /// finger off from where it was.
  virtual void press(int module, int taxel = -1) = 0;
  virtual void lift() = 0;
};

/// The way to a controller is cut: what it was doing can go on when the way is there again.
class Unreachable : public DeviceError {
 public:
  using DeviceError::DeviceError;
};

/// Whole messages to and from one address, where the operating system takes ISO-TP upon itself. Used by the link's
/// thread.
class MessageChannel {
 public:
  enum class Arrival { kNothing, kMessage, kFailed };
  virtual ~MessageChannel() = default;
  /// Starts to send; false: refused, or the last message is still under way.
  [[nodiscard]] virtual bool send(Bytes message) = 0;
  /// Does not wait. kFailed: a message was given up on the way, in either direction.
  [[nodiscard]] virtual Arrival take(std::vector<std::uint8_t>& message) = 0;
};

/// Frames to and from patch controllers, whatever carries them: CAN, USB, or the simulation. Used by one thread.
class Link {
 public:
  virtual ~Link() = default;
  /// Throws Unreachable naming the link and the cause when the link is dead.
  virtual void send(const wire::CanFrame& frame) = 0;
  /// Waits for a frame until `until_us` of the link's clock; empty: none came, or a channel has something. Throws as
  /// send does.
  virtual std::optional<wire::CanFrame> receive(std::uint64_t until_us) = 0;
  /// Time of the link, µs: monotonic; virtual in the in-process simulation, where waiting costs nothing.
  [[nodiscard]] virtual std::uint64_t now_us() const = 0;
  /// FD frames may be sent.
  [[nodiscard]] virtual bool fd() const = 0;
  /// Longest frame that may be sent, bytes.
  [[nodiscard]] virtual std::uint8_t frame_bytes() const { return fd() ? 64 : 8; }
  /// How long a controller may take for its first answer: P2 of the protocol and what the way there costs.
  [[nodiscard]] virtual std::uint64_t answer_us() const = 0;
  [[nodiscard]] virtual std::string name() const = 0;
  /// What the link itself has noticed (bus errors, unplugged devices), with the remedy; empty: nothing.
  [[nodiscard]] virtual std::string trouble() const { return {}; }
  [[nodiscard]] virtual Finger* finger() { return nullptr; }
  /// A connection whose segments the system takes care of; null: there is none, and frames must do.
  [[nodiscard]] virtual std::unique_ptr<MessageChannel> open_channel(std::uint32_t tx_id, std::uint32_t rx_id) {
    (void)tx_id, (void)rx_id;
    return nullptr;
  }
  /// Wire that leads to a node: controllers on one CAN bus share one, each USB device has its own. 0 while it is not
  /// known.
  [[nodiscard]] virtual int wire_of(std::uint8_t node) const {
    (void)node;
    return 0;
  }
  /// Tries to revive a link that was cut. Throws DeviceError when it still is.
  virtual void reconnect() {}
};

}  // namespace triskin::device
