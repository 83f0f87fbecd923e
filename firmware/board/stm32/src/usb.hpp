// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/wire/usb_function.hpp"

namespace triskin::board {

/// The chip's USB full-speed device serves one UsbFunction with end point 0, and on request 1 (interrupt) and 2 (bulk)
/// in both directions. The interrupt only wakes the loop, which does the work in serve() and send(). So the function
/// needs no locks, and the hardware answers NAK in the meantime. Full speed on PA11 and PA12; the 48 MHz come from
/// HSI48, trimmed by the host's frames.
class Stm32Usb {
 public:
  /// The data stage of a control transfer to the device has at most this size.
  static constexpr std::size_t kMaxData = 1024;

  /// Joins the bus. `function` must outlive that.
  void open(wire::UsbFunction& function, bool data_endpoints);
  /// Leaves the bus, which looks to the host like an unplugged cable.
  void close();
  /// Passes received packets on, at most one of each end point.
  void serve();
  /// Gives waiting packets to free end points.
  void send();
  /// Works while a page of the flash is erased, without reading the flash: frees end points whose packet was sent, and
  /// gives them the next one. Received packets wait for serve().
  void stream();
  /// Returns in how many µs stream() may have work, because packets are then sent without an interrupt. UINT64_MAX
  /// means that none is being sent.
  [[nodiscard]] std::uint64_t stream_again_us() const;
  /// Returns true if serve() has work.
  [[nodiscard]] bool work_waits() const { return pending_; }
  /// Returns true if no control transfer is running, so that its answer has reached the host.
  [[nodiscard]] bool idle() const { return stage_ == Stage::kIdle; }
  void on_interrupt();

 private:
  enum class Stage : std::uint8_t { kIdle, kDataOut, kDataIn, kStatusIn };
  static constexpr std::size_t kEndpoints = 3, kPacket = 64;

  void reset();
  void open_endpoint(std::size_t n, bool in, bool out);
  void serve_control(std::uint32_t state);
  void serve_data(std::size_t n, std::uint32_t state);
  void begin(Bytes setup);
  void run();
  void stall();
  void answer();
  void control_sent();
  void control_received();

  wire::UsbFunction* function_ = nullptr;
  bool data_endpoints_ = false;
  volatile bool pending_ = false;
  std::uint32_t power_ = 0;  // The value is CNTR without the interrupt masks.
  std::array<bool, kEndpoints> busy_{};
  wire::UsbSetup setup_;
  Stage stage_ = Stage::kIdle;
  std::array<std::uint8_t, kMaxData> data_{};
  std::size_t received_ = 0;
  Bytes answer_;
  bool short_packet_owed_ = false;
  std::uint8_t address_ = 0;  // The address takes effect after the status stage; 0 means that there is none.
};

extern Stm32Usb usb;

}  // namespace triskin::board
