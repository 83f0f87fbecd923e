// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>

#include "bench.hpp"
#include "triskin/core/bytes.hpp"
#include "triskin/sim/flash_model.hpp"
#include "triskin/wire/loader_protocol.hpp"

namespace triskin::machine {

using wire::loader::Command;

inline constexpr std::uint32_t kSlotA = 0x08004000, kSlotB = 0x08040000;

/// Updates the application through the loader, over CAN.
class Update : public Bench {
 protected:
  void SetUp() override {
    running_slot = 0;  // With slot 0 running, the update is written to B.
    Bench::SetUp();
    if (IsSkipped()) return;
    next = whole_blocks(read_elf(board.file("triskin_app_b.elf")));
  }
  // Returns the loader's answer to a command, or an empty one.
  [[gnu::noinline]] std::vector<std::uint8_t> command(Bytes bytes, std::uint64_t wait_us) {
    const std::size_t seen = frames.size();
    const std::uint8_t code = bytes[0];
    send(wire::loader::kRequestId, bytes);
    for (std::uint64_t t = 0; t < wait_us; t += 1000) {
      run_for(1000);
      for (std::size_t k = seen; k < frames.size(); ++k) {
        const auto& f = frames[k];
        if (f.id == wire::loader::kReplyId && f.data[0] == code)
          return std::vector<std::uint8_t>(f.data.begin(), f.data.begin() + f.size);
      }
    }
    return {};
  }
  [[gnu::noinline]] void enter_loader() {
    power_up();
    run_for(8'000);
    const auto hello = command(std::array{static_cast<std::uint8_t>(Command::kHello)}, 50'000);
    ASSERT_EQ(hello.size(), 7U);
    ASSERT_EQ(hello[2] >> 6, wire::loader::kProtocol);
    const auto selected = command(
        std::array{static_cast<std::uint8_t>(Command::kSelect), hello[3], hello[4], hello[5], hello[6]}, 20'000);
    ASSERT_FALSE(selected.empty());
  }
  // Sends the image and returns the status of the last block.
  [[gnu::noinline]] int write_image() {
    int status = -1;
    for (std::size_t at = 0; at < next.size(); at += 8) {
      send(wire::loader::kDataId, Bytes(next).subspan(at, 8));
      run_for(250);
      if (frames.back().id == wire::loader::kReplyId &&
          frames.back().data[0] == static_cast<std::uint8_t>(Command::kData))
        status = frames.back().data[1];
    }
    return status;
  }
  [[gnu::noinline]] int commit() {
    const std::uint32_t crc = crc32(next);
    const auto size = static_cast<std::uint32_t>(next.size());
    const auto reply = command(std::array{static_cast<std::uint8_t>(Command::kCommit), static_cast<std::uint8_t>(size),
                                          static_cast<std::uint8_t>(size >> 8), static_cast<std::uint8_t>(size >> 16),
                                          static_cast<std::uint8_t>(crc), static_cast<std::uint8_t>(crc >> 8),
                                          static_cast<std::uint8_t>(crc >> 16), static_cast<std::uint8_t>(crc >> 24)},
                               100'000);
    return reply.empty() ? -1 : reply[1];
  }
  [[gnu::noinline]] int erase(int slot) {
    const auto reply =
        command(std::array{static_cast<std::uint8_t>(Command::kErase), static_cast<std::uint8_t>(slot)}, 4'000'000);
    return reply.empty() ? -1 : reply[1];
  }
  void boot() {
    send(wire::loader::kRequestId, std::array{static_cast<std::uint8_t>(Command::kBoot)});
    run_for(100'000);
  }
  std::vector<std::uint8_t> next;
};

}  // namespace triskin::machine
