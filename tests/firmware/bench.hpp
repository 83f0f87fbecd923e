// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <gtest/gtest.h>

#include <deque>
#include <memory>
#include <vector>

#include "flash_double.hpp"
#include "line_double.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/sim/virtual_controller.hpp"
#include "triskin/wire/iso_tp.hpp"
#include "triskin/wire/table_state.hpp"
#include "triskin/wire/taxel_frames.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::test {

using Message = std::vector<std::uint8_t>;

/// Runs the whole application on virtual ports, with four lines of doubles and a tester on the bus.
class Bench {
 public:
  std::array<LineDouble, layout::kLines> lines;
  FlashDouble<sim::FlashModel> flash;
  bool can_fd = true;
  std::uint8_t node = 1;
  std::uint64_t now_us = 0;
  std::vector<wire::CanFrame> stream;  ///< The controller sent these frames in addition to answers.

  void power_up() {
    controller = sim::make_virtual_controller({{&lines[0], &lines[1], &lines[2], &lines[3]},
                                               &flash,
                                               {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12},
                                               [this](const wire::CanFrame& f) { arrived_.push_back(f); },
                                               can_fd});
    controller->run_until(now_us);
  }

  void run(std::uint64_t us) {
    now_us += us;
    controller->run_until(now_us);
    collect(nullptr);
  }

  /// Sends a request and waits up to 200 ms for the answer; empty if there was none.
  Message ask(const Message& request, std::uint8_t frame_bytes = 8) {
    wire::IsoTp link(wire::physical_id(node, wire::kTesterAddress), wire::physical_id(wire::kTesterAddress, node),
                     frame_bytes);
    EXPECT_EQ(link.send(request, now_us), Status::kOk);
    for (int tick = 0; tick < 2000; ++tick) {
      while (const auto f = link.transmit(now_us)) controller->receive(*f);
      now_us += 100;
      controller->run_until(now_us);
      if (collect(&link)) return {link.message().begin(), link.message().end()};
    }
    return {};
  }

  /// Sends a single frame to everybody; the answer is a single frame too.
  Message ask_all(const Message& request) {
    wire::IsoTp link(wire::kFunctionalId, wire::physical_id(wire::kTesterAddress, node), 8);
    EXPECT_EQ(link.send(request, now_us), Status::kOk);
    controller->receive(*link.transmit(now_us));
    now_us += 1000;
    controller->run_until(now_us);
    return collect(&link) ? Message{link.message().begin(), link.message().end()} : Message{};
  }

  void unlock() {
    ASSERT_EQ(ask({0x10, 0x03}).at(0), 0x50);
    const Message seed = ask({0x27, 0x01});
    ASSERT_EQ(seed.size(), 6U);
    const std::uint32_t key = wire::security_key(ByteReader(Bytes(seed).subspan(2)).be32());
    const auto byte = [&](int shift) { return static_cast<std::uint8_t>(key >> shift); };
    ASSERT_EQ(ask({0x27, 0x02, byte(24), byte(16), byte(8), byte(0)}), (Message{0x67, 0x02}));
  }

  /// Downloads and activates; returns the status byte of the activation.
  Status flash_table(const layout::PatchImage& image) {
    std::array<std::uint8_t, layout::kMaxImageBytes> bytes{};
    const std::size_t size = layout::encode(image, bytes).value();
    unlock();
    EXPECT_EQ(ask({0x34, 0x00, 0x44, 0, 1, 0, 0, 0, 0, 0, static_cast<std::uint8_t>(size)}),
              (Message{0x74, 0x20, 0, 66}));
    std::uint8_t block = 0;
    for (std::size_t at = 0; at < size; at += 64) {
      Message m{0x36, ++block};
      m.insert(m.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
               bytes.begin() + static_cast<std::ptrdiff_t>(std::min(at + 64, size)));
      EXPECT_EQ(ask(m), (Message{0x76, block}));
    }
    EXPECT_EQ(ask({0x37}), (Message{0x77}));
    const Message done = ask({0x31, 0x01, 0x02, 0x05});
    EXPECT_EQ(done.size(), 5U);
    return wire::ActivationResult::decode(Bytes(done).subspan(4)).value().status;
  }

  wire::ModuleState state(std::size_t module) {
    const Message m = ask({0x22, 0xFD, 0x03});
    return wire::ModuleStates::decode(Bytes(m).subspan(3)).value().state.at(module);
  }

  std::unique_ptr<sim::VirtualController> controller;

 private:
  bool collect(wire::IsoTp* link) {
    bool received = false;
    while (!arrived_.empty()) {
      const wire::CanFrame f = arrived_.front();
      arrived_.pop_front();
      if (link != nullptr && f.id == link->rx_id())
        received |= link->receive(f, now_us) == wire::IsoTp::Event::kReceived;
      else
        stream.push_back(f);
    }
    return received;
  }
  std::deque<wire::CanFrame> arrived_;
};

/// Makes a patch with two modules on each of the first three lines: module k at line k / 2, address k % 2.
inline layout::PatchImage six_modules(std::uint8_t node = 1) {
  layout::PatchImage image;
  image.design_id = 6;
  image.node_address = node;
  image.module_count = 6;
  for (std::uint8_t k = 0; k < 6; ++k) {
    const auto small = [](int x) { return static_cast<std::uint8_t>(x); };
    image.modules[k] = {small(10 + k),
                        small(k / 2),
                        small(k % 2),
                        0,
                        k == 0 ? layout::kNoParent : small(k - 1),
                        k == 0 ? layout::kCable : std::uint8_t{1}};
  }
  return image;
}

inline void place_six(Bench& bench) {
  for (int k = 0; k < 6; ++k) {
    ChipDouble chip;
    chip.address = layout::cdc_address(k % 2);
    for (int t = 0; t < layout::kTaxelsPerModule; ++t)
      chip.counts[static_cast<std::size_t>(t)] = 8000 + 97 * k + 31 * t;
    bench.lines[static_cast<std::size_t>(k / 2)].chips.push_back(chip);
  }
}

}  // namespace triskin::test
