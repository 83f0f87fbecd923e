// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "triskin/wire/can_frame.hpp"

struct canfd_frame;

namespace triskin::device {

/// A raw SocketCAN socket: classic and FD frames, error frames, bus-off. Threads: one.
class CanSocket {
 public:
  /// Errors that the interface's controller chip reported since the socket was opened.
  struct Errors {
    std::uint64_t frames = 0;     ///< It counts error frames.
    bool bus_off = false;         ///< It is true until the interface says that it was restarted.
    bool passive = false;         ///< The controller is error passive or at the warning level.
    bool unacknowledged = false;  ///< Nobody acknowledged the last frame.
  };

  /// Throws DeviceError naming the interface and how to bring it up: no such interface, it is down, no CAN in the
  /// kernel.
  explicit CanSocket(const std::string& interface);
  ~CanSocket();
  CanSocket(const CanSocket&) = delete;
  CanSocket& operator=(const CanSocket&) = delete;

  /// True: the interface carries FD frames (its MTU is that of FD).
  [[nodiscard]] bool fd() const { return fd_; }
  /// File descriptor for poll(), owned by the socket.
  [[nodiscard]] int descriptor() const { return socket_; }
  /// Sets the kernel's receive filter: from now on only answers of controllers, claims, streams and the loader arrive.
  void filter_for_host();
  /// From now on every data frame of the bus arrives.
  void drop_filter();
  /// Sends one frame; waits while the transmit queue is full, up to 1 s. Throws Unreachable: interface gone or down,
  /// bus-off, queue stays full.
  void send(const wire::CanFrame& frame);
  /// The next frame in the queue, or empty; does not wait. Error frames are counted in errors() and not returned.
  /// Throws Unreachable: interface gone or down.
  std::optional<wire::CanFrame> receive();
  /// Errors since the socket was opened.
  [[nodiscard]] const Errors& errors() const { return errors_; }
  /// False: the interface was gone or down at the last send or receive.
  [[nodiscard]] bool alive() const { return alive_; }
  /// Frames that found the receive queue full since the socket was opened.
  [[nodiscard]] std::uint32_t thrown_away() const { return thrown_away_; }
  /// One sentence on errors() with the remedy; empty: no errors.
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

}  // namespace triskin::device
