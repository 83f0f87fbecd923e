// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <vector>

#include "triskin/wire/iso_tp.hpp"
#include "triskin/wire/sampling.hpp"
#include "triskin/wire/uds.hpp"
#include "triskin/wire/usb_packet.hpp"
#include "usb_host.hpp"

namespace triskin::machine {

/// Reads the full stream over bulk, and sends requests meanwhile.
class UsbStream {
 public:
  explicit UsbStream(Machine& machine) : machine_(machine), host_(machine) {}
  /// Enumerates and configures the device.
  bool open() { return host_.connect(9) && host_.control({0x00, 9, 1, 0, 0}).has_value(); }
  /// Selects the shortest sequence, and the full stream to this host. Returns false if the device refused.
  bool unlock_and_stream() {
    std::vector<wire::CanFrame> others;
    if (ask({0x10, 0x03}, others).empty()) return false;
    const auto seed = ask({0x27, 0x01}, others);
    if (seed.size() != 6) return false;
    const std::uint32_t key = wire::security_key(ByteReader(Bytes(seed).subspan(2)).be32());
    (void)ask({0x27, 0x02, static_cast<std::uint8_t>(key >> 24), static_cast<std::uint8_t>(key >> 16),
               static_cast<std::uint8_t>(key >> 8), static_cast<std::uint8_t>(key)},
              others);
    (void)ask({0x2E, 0xFD, 0x0A, static_cast<std::uint8_t>(wire::Decimation::k64), 1, 0}, others);
    const auto streaming = ask({0x2E, 0xFD, 0x05, 0x02}, others);
    return !streaming.empty() && streaming[0] == 0x6E;
  }
  /// Returns the next frame that the device sends; empty if there is none within a millisecond.
  std::optional<wire::CanFrame> next() {
    const auto frame = wire::from_usb(host_.in(wire::kBulkIn, 1'000));
    return frame ? std::optional(*frame) : std::nullopt;
  }
  /// Sends one request and returns its answer, empty after 300 ms. Frames of the stream that arrive meanwhile go into
  /// `others`.
  std::vector<std::uint8_t> ask(const std::vector<std::uint8_t>& bytes, std::vector<wire::CanFrame>& others) {
    wire::IsoTp tester(wire::physical_id(1, wire::kTesterAddress), wire::physical_id(wire::kTesterAddress, 1),
                       wire::kUsbFrameBytes);
    if (tester.send(bytes, machine_.now_us()) != Status::kOk) return {};
    for (const std::uint64_t until = machine_.now_us() + 300'000; machine_.now_us() < until;) {
      (void)tester.tick(machine_.now_us());
      while (const auto f = tester.transmit(machine_.now_us())) {
        const auto packet = wire::to_usb(*f);
        if (!packet || !host_.out(wire::kBulkOut, packet->used())) return {};
      }
      const auto frame = next();
      if (!frame) continue;
      if (tester.receive(*frame, machine_.now_us()) != wire::IsoTp::Event::kReceived) {
        others.push_back(*frame);
        continue;
      }
      const Bytes m = tester.message();
      return {m.begin(), m.end()};
    }
    return {};
  }

 private:
  Machine& machine_;
  UsbHost host_;
};

}  // namespace triskin::machine
