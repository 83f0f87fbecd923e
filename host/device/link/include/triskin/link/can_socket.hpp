// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "triskin/wire/can_frame.hpp"

struct canfd_frame;

namespace triskin::link {

/// A raw SocketCAN socket carries classic and FD frames, error frames and bus-off. Threads: one.
class CanSocket {
 public:
  /// The interface's controller chip has reported these errors since the socket was opened.
  struct Errors {
    std::uint64_t frames = 0;     ///< Every error frame is counted.
    bool bus_off = false;         ///< Bus-off lasts until the interface reports that it was restarted.
    bool passive = false;         ///< The controller is error passive or at the warning level.
    bool unacknowledged = false;  ///< No other node acknowledged the last frame.
  };

  /// Throws DeviceError naming the interface and how to bring it up: no such interface, it is down, no CAN in the
  /// kernel.
  explicit CanSocket(const std::string& interface);
  ~CanSocket();
  CanSocket(const CanSocket&) = delete;
  CanSocket& operator=(const CanSocket&) = delete;

  /// Returns true if the interface carries FD frames (its MTU is that of FD).
  [[nodiscard]] bool fd() const { return fd_; }
  /// Returns the file descriptor for poll(), which the socket owns.
  [[nodiscard]] int descriptor() const { return socket_; }
  /// Sets the kernel's receive filter, so that only answers of controllers, claims, streams and the loader are
  /// received.
  void filter_for_host();
  /// Removes the filter, so that every data frame of the bus is received.
  void drop_filter();
  /// Sends one frame; waits up to 1 s while the transmit queue is full. Throws Unreachable: interface missing or down,
  /// bus-off, queue stays full.
  void send(const wire::CanFrame& frame);
  /// Returns the next frame in the queue, or nothing, without waiting. Error frames are only counted in errors().
  /// Throws Unreachable: interface missing or down.
  std::optional<wire::CanFrame> receive();
  /// Returns the errors since the socket was opened.
  [[nodiscard]] const Errors& errors() const { return errors_; }
  /// Returns false if the interface was missing or down at the last send or receive.
  [[nodiscard]] bool alive() const { return alive_; }
  /// Counts the frames that found the receive queue full since the socket was opened.
  [[nodiscard]] std::uint32_t thrown_away() const { return thrown_away_; }
  /// Describes errors() in one sentence with the remedy; empty if there are none.
  [[nodiscard]] std::string trouble() const;

 private:
  std::ptrdiff_t read_frame(canfd_frame* frame);
  void note_error(std::uint32_t error_class, const std::uint8_t* data);
  [[noreturn]] void fail(const std::string& what, int error);

  std::string interface_;
  int socket_ = -1;
  bool fd_ = false, alive_ = true;
  Errors errors_;
  std::uint32_t thrown_away_ = 0;
};

}  // namespace triskin::link
