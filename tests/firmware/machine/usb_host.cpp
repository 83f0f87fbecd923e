// SPDX-License-Identifier: GPL-3.0-or-later
#include "usb_host.hpp"

#include <algorithm>
#include <array>

namespace triskin::machine {
namespace {

constexpr std::size_t kPacket = 64;
constexpr std::uint64_t kControl_us = 5'000'000, kRetry_us = 40;

std::array<std::uint8_t, 8> bytes_of(const wire::UsbSetup& s) {
  std::array<std::uint8_t, 8> bytes{};
  ByteWriter w(bytes);
  w.u8(s.type);
  w.u8(s.request);
  w.le16(s.value);
  w.le16(s.index);
  w.le16(s.length);
  return bytes;
}

}  // namespace

// Adds the time of token, data and handshake at 12 Mbit/s: about ten bytes besides the data.
UsbReply UsbHost::spend(UsbReply reply, std::size_t bytes) {
  machine_.run_until(machine_.now_us() + (reply == UsbReply::kNak ? kRetry_us : 1 + (bytes + 10) * 8 / 12));
  return reply;
}

UsbReply UsbHost::send(std::uint8_t endpoint, bool data1, Bytes packet, std::uint64_t patience_us) {
  const std::uint64_t until = machine_.now_us() + patience_us;
  UsbReply reply = UsbReply::kNak;
  while (reply == UsbReply::kNak && machine_.now_us() < until)
    reply = spend(wire().out(address_, endpoint, data1, packet), packet.size());
  return reply;
}

UsbIn UsbHost::receive(std::uint8_t endpoint, std::uint64_t patience_us) {
  const std::uint64_t until = machine_.now_us() + patience_us;
  UsbIn in{UsbReply::kNak, false, {}};
  do {
    in = wire().in(address_, endpoint);
    spend(in.reply, in.bytes.size());
  } while (in.reply == UsbReply::kNak && machine_.now_us() < until);
  return in;
}

// A device whose last transfer is not served yet does not answer, so a host tries three times.
bool UsbHost::begin(const wire::UsbSetup& setup) {
  for (int k = 0; k < 3; ++k) {
    if (spend(wire().setup(address_, bytes_of(setup)), 8) == UsbReply::kAck) return true;
    machine_.run_until(machine_.now_us() + 1000);
  }
  return false;
}

std::optional<std::vector<std::uint8_t>> UsbHost::data_in(std::uint16_t length) {
  std::vector<std::uint8_t> all;
  for (bool data1 = true; all.size() < length; data1 = !data1) {
    const UsbIn in = receive(0, kControl_us);
    if (in.reply != UsbReply::kAck) return std::nullopt;
    if (in.data1 != data1) ++toggle_errors;
    all.insert(all.end(), in.bytes.begin(), in.bytes.end());
    if (in.bytes.size() < kPacket) break;
  }
  if (send(0, true, {}, kControl_us) != UsbReply::kAck) return std::nullopt;
  return all;
}

std::optional<std::vector<std::uint8_t>> UsbHost::control(const wire::UsbSetup& setup, Bytes data) {
  if (!begin(setup)) return std::nullopt;
  if (setup.to_host()) return data_in(setup.length);
  bool data1 = true;
  for (std::size_t at = 0; at < data.size(); at += kPacket, data1 = !data1) {
    if (send(0, data1, data.subspan(at, std::min(kPacket, data.size() - at)), kControl_us) != UsbReply::kAck)
      return std::nullopt;
  }
  const UsbIn status = receive(0, kControl_us);
  if (status.reply != UsbReply::kAck || !status.bytes.empty()) return std::nullopt;
  if (!status.data1) ++toggle_errors;
  if (setup.type == 0 && setup.request == 9) toggle_.clear();  // The request is SET_CONFIGURATION.
  return std::vector<std::uint8_t>{};
}

bool UsbHost::connect(std::uint8_t address) {
  for (const std::uint64_t until = machine_.now_us() + 1'000'000; !wire().attached();
       machine_.run_until(machine_.now_us() + 1000)) {
    if (machine_.now_us() >= until) return false;
  }
  address_ = 0;
  toggle_.clear();
  wire().bus_reset();
  machine_.run_until(machine_.now_us() + 10'000);
  if (!control({0x00, 5, address, 0, 0})) return false;
  machine_.run_until(machine_.now_us() + 2'000);
  address_ = address;
  return true;
}

bool UsbHost::out(std::uint8_t endpoint, Bytes packet) {
  bool& data1 = toggle_[endpoint];
  if (send(endpoint, data1, packet, 100'000) != UsbReply::kAck) return false;
  data1 = !data1;
  return true;
}

bool UsbHost::repeat_out(std::uint8_t endpoint, Bytes packet) {
  return send(endpoint, !toggle_[endpoint], packet, 100'000) == UsbReply::kAck;
}

std::vector<std::uint8_t> UsbHost::in(std::uint8_t endpoint, std::uint64_t wait_us) {
  const UsbIn in = receive(endpoint & 0xF, wait_us);
  if (in.reply != UsbReply::kAck) return {};
  bool& data1 = toggle_[endpoint];
  if (in.data1 != data1) ++toggle_errors;
  data1 = !in.data1;
  return in.bytes;
}

}  // namespace triskin::machine
