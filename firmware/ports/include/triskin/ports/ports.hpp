// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "triskin/core/bytes.hpp"
#include "triskin/core/status.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/ports/route_chain.hpp"
#include "triskin/wire/can_frame.hpp"
#include "triskin/wire/health.hpp"
#include "triskin/wire/identity.hpp"
#include "triskin/wire/unique_id.hpp"

/// Interfaces of a board, as application and loader use them. Implemented in firmware/board; `Ports` joins them. No
/// call blocks but those that say so.
namespace triskin::fw {

/// One I²C line. A transfer writes bytes, then reads bytes after a repeated start (either may be empty), in the
/// background.
class I2cLine {
 public:
  virtual ~I2cLine() = default;
  /// Buffers must live until poll() reports the end. Only one transfer at a time.
  virtual void start(std::uint8_t address, Bytes write, std::span<std::uint8_t> read) = 0;
  /// Empty while busy; then kOk, kBusError (no acknowledgement) or kLineStuck. Reported once.
  virtual std::optional<Status> poll() = 0;
  /// When the last transfer that poll() reported began and ended on the line. A chip that stretches the clock, or a
  /// transfer that the line had to make again, makes it longer.
  [[nodiscard]] virtual std::uint64_t started_us() const = 0;
  [[nodiscard]] virtual std::uint64_t ended_us() const = 0;
  /// Bus clear (UM10204 3.1.16): up to nine clock pulses, stop, re-initialization. Takes under 200 µs. kOk: both wires
  /// are high; kLineStuck: one is still held low.
  virtual Status recover() = 0;
};

/// Time of the board.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual std::uint64_t now_us() const = 0;  ///< time since power-up, monotonic
};

/// Frames to and from hosts: a CAN bus, or USB with the same frames in its packets.
class CanPort {
 public:
  virtual ~CanPort() = default;
  /// True when FD frames may be sent: both ends and every node must know FD.
  [[nodiscard]] virtual bool fd() const = 0;
  /// Longest frame, bytes.
  [[nodiscard]] virtual std::uint8_t frame_bytes() const { return fd() ? 64 : 8; }
  /// False: the queue is full; try again later.
  virtual bool send(const wire::CanFrame& frame) = 0;
  [[nodiscard]] virtual bool has_room() const { return true; }  ///< send() would take a frame
  /// Oldest frame that came and was not taken yet; empty: none.
  virtual std::optional<wire::CanFrame> receive() = 0;
};

/// A serial port for text to a person.
class SerialPort {
 public:
  virtual ~SerialPort() = default;
  /// False: there is no room; try again later.
  virtual bool send(std::uint8_t byte) = 0;
};

/// Non-volatile memory with the rules of the silicon: erase by page to ones, program aligned units once.
class FlashArea {
 public:
  virtual ~FlashArea() = default;
  /// Bytes of the area; a multiple of page_bytes().
  [[nodiscard]] virtual std::size_t size_bytes() const = 0;
  /// Bytes that one erase_page() erases.
  [[nodiscard]] virtual std::size_t page_bytes() const = 0;
  /// Bytes of one unit: the least that program() writes.
  [[nodiscard]] virtual std::size_t program_bytes() const = 0;
  /// Erases the page that begins at `offset` (bytes from the start of the area). Waits for the end. False: misaligned,
  /// out of range, or the silicon failed.
  [[nodiscard]] virtual bool erase_page(std::size_t offset) = 0;
  /// Writes whole units at `offset`, which is a multiple of program_bytes(); each unit once after its erase. False:
  /// misaligned, out of range, not erased, or the silicon failed.
  [[nodiscard]] virtual bool program(std::size_t offset, Bytes bytes) = 0;
  /// The whole area as it reads now; erased bytes read 0xFF. Valid as long as the area.
  [[nodiscard]] virtual Bytes bytes() const = 0;
};

/// Reset into the loader, which then starts an application. Boards without a loader have none.
class Restart {
 public:
  virtual ~Restart() = default;
  /// May return when the board needs some time; the application does nothing more.
  virtual void restart() = 0;
  /// The image that runs has done its work once and keeps its slot. Writes one unit of the flash, the first time.
  virtual void confirm() {}
  /// The image that runs. Empty: not started from a slot.
  virtual std::optional<wire::ImageState> image_state() = 0;
};

/// What a board knows about itself. Boards that know nothing have none.
class BoardMonitor {
 public:
  virtual ~BoardMonitor() = default;
  /// Returns the present state.
  [[nodiscard]] virtual wire::BoardHealth health() const = 0;
  /// The crash that a reset has left behind. Empty: none since power-up, or it was cleared.
  [[nodiscard]] virtual std::optional<wire::Crash> crash() const = 0;
  /// Called when a host clears the fault memory.
  virtual void forget_crash() = 0;
  /// Protects the loader against being written, or ends that, from the next power-up on. Takes 25 ms. False: the board
  /// cannot, or not now.
  virtual bool protect_loader(bool) { return false; }
};

/// Takes another image of the application while this one runs (wire/image_update.hpp). Its calls and the work inside
/// step() are short but for the erase of a page, during which the board goes on as for its tables.
class ImageUpdate {
 public:
  virtual ~ImageUpdate() = default;
  /// True: the frame was one of an update.
  virtual bool handle(const wire::CanFrame& frame, std::uint64_t now_us) = 0;
  /// True while the units of a data frame wait for the flash: the next frame is taken from the port after step().
  [[nodiscard]] virtual bool full() const = 0;
  /// One piece of the work that is due; answers leave by `port`.
  virtual void step(CanPort& port, std::uint64_t now_us) = 0;
  /// When step() has work next, µs; not counting frames.
  [[nodiscard]] virtual std::uint64_t next_event_us(std::uint64_t now_us) const = 0;
};

/// Everything a board gives to the application.
struct Ports {
  std::array<I2cLine*, layout::kLines> lines;
  Clock* clock;
  CanPort* can;
  FlashArea* flash;
  wire::UniqueId unique_id;
  CanPort* usb = nullptr;           ///< null: the board has no USB
  RouteChain* chain = nullptr;      ///< chain of the switched modules; null: the board has none
  Restart* restart = nullptr;       ///< null: a reset only starts the application anew
  ImageUpdate* update = nullptr;    ///< null: new images come by the loader alone
  BoardMonitor* monitor = nullptr;  ///< null: nothing to say about the board
  SerialPort* serial = nullptr;     ///< port for the log; null: the board has none
};

}  // namespace triskin::fw
