// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "triskin/scene/scene.hpp"
#include "triskin/wire/can_frame.hpp"

namespace triskin::device {

/// A finger that the host can move: only simulated links have one.
class Finger {
 public:
  virtual ~Finger() = default;
  /// Presses a module at its centre, wide enough for all of its taxels, or one taxel (0..11) with the tip. Takes the finger off
  /// from where it was.
  virtual void press(int module, int taxel = -1) = 0;
  virtual void lift() = 0;
};

/// Frames to and from patch controllers, whatever carries them: CAN, USB, or the simulation. Used by one thread.
class Link {
 public:
  virtual ~Link() = default;
  /// Throws DeviceError naming the link and the cause when the link is dead.
  virtual void send(const wire::CanFrame& frame) = 0;
  /// Waits for a frame until `until_us` of the link's clock; empty: none came. Throws DeviceError as send does.
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
};

/// What `--link` and `--scene` name.
struct LinkOptions {
  std::string link = "sim";
  std::string scene;  ///< scene file for `sim`; empty: the design, with nothing wrong
  bool switched = false;  ///< `sim` without a scene file has switched modules
};

/// Opens `sim`, `sim:HOST:PORT`, `can:IFACE`, `hid[:SERIAL]` or `usb[:SERIAL]`. The design is what `sim` simulates when
/// there is no scene; null where a command has none. Throws InputError (unknown link, no design or scene for `sim`, a scene of
/// another design), DeviceError (cannot connect).
[[nodiscard]] std::unique_ptr<Link> open_link(const LinkOptions& options, const model::Design* design);

}  // namespace triskin::device
