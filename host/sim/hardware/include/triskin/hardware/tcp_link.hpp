// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "triskin/link/link.hpp"
#include "triskin/link/touch_actuator.hpp"
#include "triskin/wire/bus_load.hpp"

namespace triskin::hardware {

struct HostPort {
  std::string host;
  std::uint16_t port = 0;
};
/// Splits "HOST:PORT", port 0 … 65535. An IPv6 address is in brackets, "[::1]:7000", as in a URL, and `host` is
/// without them. Throws InputError.
[[nodiscard]] HostPort parse_host_port(const std::string& text);
/// Formats the text that parse_host_port() reads.
[[nodiscard]] std::string host_port_text(const HostPort& at);

/// Records between `sim:HOST:PORT` and `triskin simulate --listen` have 4 bytes length of the rest (little-endian), 1
/// byte kind, then the contents. Both sides refuse records longer than kMaxBytes.
namespace record {
inline constexpr std::uint8_t kCanFrame =
    1;  ///< The contents are id (4, bit 31: 29 bits, bit 30: FD, bit 29: rate switch), then the data.
inline constexpr std::uint8_t kPress =
    2;  ///< The contents are module (4) and taxel (1) or kWholeModule; the virtual finger then presses only there.
inline constexpr std::uint8_t kWholeModule = 0xFF;
inline constexpr std::uint8_t kLift = 3;
inline constexpr std::uint8_t kBitRates =
    4;  ///< The first record of the server has the rates of the simulated bus: nominal (4), data (4).
/// The contents are module (4; kAllModules for all) and Pa (4), the pressure on its taxels.
inline constexpr std::uint8_t kPressure = 5;
inline constexpr std::uint32_t kAllModules = 0xFFFFFFFF;
inline constexpr std::size_t kMaxBytes = 4096;

/// Appends a record of at most kMaxBytes to `out`.
void put(std::vector<std::uint8_t>& out, std::uint8_t kind, std::span<const std::uint8_t> contents);
/// Appends a record of kind kCanFrame.
void put_frame(std::vector<std::uint8_t>& out, const wire::CanFrame& frame);

struct Record {
  std::uint8_t kind = 0;
  std::vector<std::uint8_t> contents;
};
/// Removes the first whole record from `in`; empty when there is none yet. Throws DeviceError when its length is 0 or
/// above kMaxBytes.
[[nodiscard]] std::optional<Record> take(std::vector<std::uint8_t>& in);
/// Decodes a record of kind kCanFrame. Throws DeviceError when the contents are not a frame.
[[nodiscard]] wire::CanFrame frame_of(const Record& record);
}  // namespace record

/// The simulation runs in another process (`triskin simulate SCENE --listen HOST:PORT`), in real time. Threads: one.
class TcpLink final : public link::Link, public link::TouchActuator {
 public:
  /// Connects to a simulation. Throws InputError for port 0, DeviceError if nothing listens there or answers within 5
  /// s. Later, send() throws DeviceError if the simulation accepts no data for 2 s, and Cancelled if the process is
  /// asked to end meanwhile.
  explicit TcpLink(const HostPort& to);
  ~TcpLink() override;
  TcpLink(const TcpLink&) = delete;
  TcpLink& operator=(const TcpLink&) = delete;

  void send(const wire::CanFrame& frame) override;
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override;
  [[nodiscard]] std::uint64_t now_us() const override;
  [[nodiscard]] bool fd() const override { return true; }
  [[nodiscard]] std::uint64_t answer_us() const override { return 2'000'000; }
  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] std::string when_silent() const override;
  void press(layout::ModuleId module) override;
  void press(layout::TaxelId taxel) override;
  void lift() override;
  void pressurize(layout::ModuleId module, double kpa) override;
  /// The value is known once the first frame has arrived.
  [[nodiscard]] std::uint64_t sample_ns(std::uint8_t) const override { return wire::full_sample_ns(rates_); }

 private:
  /// Sends where the finger presses; `pad` is a taxel or record::kWholeModule.
  void send_press(layout::ModuleId module, std::uint8_t pad);
  void write_all(const std::vector<std::uint8_t>& bytes);
  /// Returns the next frame among the received bytes; empty if none is complete.
  std::optional<wire::CanFrame> frame_received();
  void read_chunk();
  [[noreturn]] void fail(const std::string& what) const;

  std::string name_;
  int socket_ = -1;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::vector<std::uint8_t> in_;
  wire::BitRates rates_;
  bool has_greeted_ = false;  // A simulation announces its bit rates before it sends anything else.
};

}  // namespace triskin::hardware
