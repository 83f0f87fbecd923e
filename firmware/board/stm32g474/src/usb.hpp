// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/wire/usb_function.hpp"

namespace triskin::board {

/// The USB full-speed device of the chip for one UsbFunction: end point 0, and when asked for 1 (interrupt) and 2
/// (bulk) each way. The interrupt only wakes the loop, which does the work in serve() and send(): the function needs no
/// locks, and the hardware answers NAK meanwhile. Full speed on PA11 and PA12; the 48 MHz come from HSI48, trimmed by
/// the host's frames.
class Stm32Usb {
 public:
  static constexpr std::size_t kMaxData = 1024;  ///< data stage of a control transfer to the device

  /// Joins the bus. `function` outlives that.
  void open(wire::UsbFunction& function, bool data_endpoints);
  /// Leaves the bus.
  void close();
  /// Hands over what came: at most one packet of each end point.
  void serve();
  /// Hands packets that wait to end points that are free.
  void send();
  /// While a page of the flash is erased: takes back end points whose packet has left, and gives them the next one.
  /// What came waits for serve(). Neither reads the flash.
  void stream();
  /// When stream() may have work, µs from now: packets leave without an interrupt then. UINT64_MAX: none is under way.
  [[nodiscard]] std::uint64_t stream_again_us() const;
  /// serve() has something to do.
  [[nodiscard]] bool work_waits() const { return pending_; }
  /// No control transfer is under way: its answer has reached the host.
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
  std::uint32_t power_ = 0;  // CNTR without the interrupt masks
  std::array<bool, kEndpoints> busy_{};
  wire::UsbSetup setup_;
  Stage stage_ = Stage::kIdle;
  std::array<std::uint8_t, kMaxData> data_{};
  std::size_t received_ = 0;
  Bytes answer_;
  bool short_packet_owed_ = false;
  std::uint8_t address_ = 0;  // Takes effect after the status stage; 0: none.
};

extern Stm32Usb usb;

}  // namespace triskin::board
