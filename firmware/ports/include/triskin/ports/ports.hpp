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

/// Application and loader use a board through these interfaces. firmware/board implements them, and `Ports` joins them.
/// No call blocks unless its comment says so.
namespace triskin::fw {

/// A transfer on an I²C line writes bytes, then reads bytes after a repeated start (either may be empty), in the
/// background.
class I2cLine {
 public:
  virtual ~I2cLine() = default;
  /// Starts a transfer. Buffers must live until poll() reports the end. Only one transfer may run at a time.
  virtual void start(std::uint8_t address, Bytes write, std::span<std::uint8_t> read) = 0;
  /// Returns nothing while busy; then, once, kOk, kBusError (no acknowledgement) or kLineStuck.
  virtual std::optional<Status> poll() = 0;
  /// Returns when the last transfer that poll() reported began; ended_us() returns when it ended on the line. A chip
  /// that stretches the clock, or a repeated transfer, makes it longer.
  [[nodiscard]] virtual std::uint64_t started_us() const = 0;
  [[nodiscard]] virtual std::uint64_t ended_us() const = 0;
  /// Clears the bus (UM10204 3.1.16) with up to nine clock pulses, stop and re-initialization. Takes under 200 µs.
  /// Returns kOk if both wires are high, kLineStuck if one is still held low.
  virtual Status recover() = 0;
};

class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual std::uint64_t now_us() const = 0;  ///< The time counts from power-up and is monotonic.
};

/// Frames go to and from hosts over a CAN bus, or over USB with the same frames in its packets.
class CanPort {
 public:
  virtual ~CanPort() = default;
  /// Returns true when FD frames may be sent, which both ends and every node must support.
  [[nodiscard]] virtual bool fd() const = 0;
  /// Returns the length of the longest frame in bytes.
  [[nodiscard]] virtual std::uint8_t frame_bytes() const { return fd() ? 64 : 8; }
  /// Sends a frame. Returns false if the queue is full; try again later.
  virtual bool send(const wire::CanFrame& frame) = 0;
  [[nodiscard]] virtual bool has_room() const { return true; }  ///< True means that send() would accept a frame.
  /// Returns the oldest received frame that was not read yet, or nothing.
  virtual std::optional<wire::CanFrame> receive() = 0;
};

/// A serial port sends text to a person.
class SerialPort {
 public:
  virtual ~SerialPort() = default;
  /// Sends a byte. Returns false if there is no room; try again later.
  virtual bool send(std::uint8_t byte) = 0;
};

/// The non-volatile memory has the rules of the silicon: pages are erased to ones, and aligned units are programmed
/// once.
class FlashArea {
 public:
  virtual ~FlashArea() = default;
  /// Returns the size of the area in bytes, a multiple of page_bytes().
  [[nodiscard]] virtual std::size_t size_bytes() const = 0;
  /// Returns the number of bytes that one erase_page() erases.
  [[nodiscard]] virtual std::size_t page_bytes() const = 0;
  /// Returns the number of bytes in one unit, the least that program() writes.
  [[nodiscard]] virtual std::size_t program_bytes() const = 0;
  /// Erases the page that begins at `offset` (bytes from the start of the area) and waits for the end. Returns false:
  /// misaligned, out of range, or the silicon failed.
  [[nodiscard]] virtual bool erase_page(std::size_t offset) = 0;
  /// Writes whole units at `offset`, which is a multiple of program_bytes(); each unit may be written once after its
  /// erase. Returns false: misaligned, out of range, not erased, or the silicon failed.
  [[nodiscard]] virtual bool program(std::size_t offset, Bytes bytes) = 0;
  /// Returns the whole area as it reads now; erased bytes read 0xFF. The view is valid as long as the area.
  [[nodiscard]] virtual Bytes bytes() const = 0;
};

/// A restart goes through the loader, which then starts an application. Boards without a loader do not have it.
class Restart {
 public:
  virtual ~Restart() = default;
  /// Restarts the board. It may return when the board needs some time; the application then does nothing more.
  virtual void restart() = 0;
  /// Confirms that the running image has worked once, so that it keeps its slot. The first call writes one unit of the
  /// flash.
  virtual void confirm() {}
  /// Returns the running image; empty if it was not started from a slot.
  virtual std::optional<wire::ImageState> image_state() = 0;
};

/// A board reports facts about itself here. Boards without such knowledge do not have a monitor.
class BoardMonitor {
 public:
  virtual ~BoardMonitor() = default;
  [[nodiscard]] virtual wire::BoardHealth health() const = 0;
  /// Returns the crash that a reset has left behind; empty if there was none since power-up, or it was cleared.
  [[nodiscard]] virtual std::optional<wire::Crash> crash() const = 0;
  /// The application calls it when a host clears the fault memory.
  virtual void forget_crash() = 0;
  /// Write-protects the loader, or ends that, from the next power-up on. Takes 25 ms. Returns false if the board cannot
  /// do this, or not now.
  virtual bool protect_loader(bool) { return false; }
};

/// Receives another image of the application while this one runs (wire/image_update.hpp). Its calls and the work inside
/// step() are short, except for the erase of a page, during which the board continues as for its tables.
class ImageUpdate {
 public:
  virtual ~ImageUpdate() = default;
  /// Handles a frame. Returns true if it was one of an update.
  virtual bool handle(const wire::CanFrame& frame, std::uint64_t now_us) = 0;
  /// Returns true while the units of a data frame wait for the flash; then the port is read again only after step().
  [[nodiscard]] virtual bool full() const = 0;
  /// Performs one piece of the due work; answers are sent by `port`.
  virtual void step(CanPort& port, std::uint64_t now_us) = 0;
  /// Returns when step() has work next in µs, not counting frames.
  [[nodiscard]] virtual std::uint64_t next_event_us(std::uint64_t now_us) const = 0;
};

/// A board provides all of this for the application.
struct Ports {
  std::array<I2cLine*, layout::kLines> lines;
  Clock* clock;
  CanPort* can;
  FlashArea* flash;
  wire::UniqueId unique_id;
  CanPort* usb = nullptr;           ///< Null means that the board has no USB.
  RouteChain* chain = nullptr;      ///< The chain leads to the switched modules; null means that the board has none.
  Restart* restart = nullptr;       ///< Null means that a reset only restarts the application.
  ImageUpdate* update = nullptr;    ///< Null means that only the loader can receive new images.
  BoardMonitor* monitor = nullptr;  ///< Null means that nothing is known about the board.
  SerialPort* serial = nullptr;     ///< The port is for the log; null means that the board has none.
};

}  // namespace triskin::fw
