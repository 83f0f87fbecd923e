// SPDX-License-Identifier: GPL-3.0-or-later
// Whatever arrives, and whatever nobody takes, application and loader get on: the simulation throws std::logic_error
// when the firmware asks for the same past again and again. Afterwards a reset leads back to the state after power-up.
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "bench.hpp"
#include "firmware_image.hpp"
#include "support/package_bytes.hpp"
#include "triskin/layout/firmware_package.hpp"
#include "triskin/wire/adoption.hpp"
#include "triskin/wire/image_update.hpp"
#include "triskin/wire/loader_protocol.hpp"
#include "triskin/wire/node_claim.hpp"
#include "triskin/wire/stream_lease.hpp"

namespace triskin::test {
namespace {

using wire::loader::Command;

constexpr wire::UniqueId kId{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
constexpr std::uint16_t kSession = 0x1234;

/// A board with a loader and both slots, on a bus that may stop taking frames.
class Board {
 public:
  std::array<LineDouble, layout::kLines> lines;
  FlashDouble<sim::FlashModel> flash, slots{sim::kSlotsBytes / 2048};
  std::unique_ptr<sim::VirtualController> controller;
  std::uint64_t now_us = 0;
  bool room = true;
  std::deque<wire::CanFrame> sent;

  Board() {
    const auto image = image_for(0, 0x00020000, 1024, 1);
    (void)slots.program(0, image);
    (void)slots.program(sim::kSlotsBytes / 2 - 2048, commit_record(image));
    for (int k = 0; k < 2; ++k) {
      ChipDouble chip;
      chip.address = layout::cdc_address(k);
      lines[0].chips.push_back(chip);
    }
    controller = sim::make_virtual_controller({.lines = {&lines[0], &lines[1], &lines[2], &lines[3]},
                                               .flash = &flash,
                                               .unique_id = kId,
                                               .send = [this](const wire::CanFrame& f) { sent.push_back(f); },
                                               .slots = &slots,
                                               .room = [this] { return room; }});
  }
  void run(std::uint64_t us) {
    now_us += us;
    controller->run_until(now_us);
  }
  std::uint8_t node() {
    sent.clear();
    controller->receive(wire::who_is_there());
    run(1'000);
    wire::IdFrames frames;
    for (const wire::CanFrame& f : sent) {
      if (f.id != wire::claim_id(kId)) continue;
      if (const auto claim = frames.add(f)) return claim->a;
    }
    return 0;
  }
  /// A request and answer of one frame each; empty without an answer.
  Message ask(std::uint8_t to, const Message& request) {
    wire::IsoTp link(wire::physical_id(to, wire::kTesterAddress), wire::physical_id(wire::kTesterAddress, to), 8);
    (void)link.send(request, now_us);
    sent.clear();
    controller->receive(*link.transmit(now_us));
    run(2'000);
    for (const wire::CanFrame& f : sent) {
      if (f.id == link.rx_id() && link.receive(f, now_us) == wire::IsoTp::Event::kReceived)
        return {link.message().begin(), link.message().end()};
    }
    return {};
  }
};

/// Draws frames of every protocol that the firmware knows, most of them right.
class Traffic {
 public:
  explicit Traffic(std::uint32_t seed) : dice_(seed) {}
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(dice_() % n); }
  std::uint8_t byte() { return static_cast<std::uint8_t>(dice_()); }

  wire::CanFrame frame(std::uint8_t node) {
    switch (below(8)) {
      case 0:
        return update();
      case 1:
        return loader();
      case 2:
        return addresses();
      case 3:
        return shared_frames();
      case 4:
        return icub();
      default:
        return request(node);
    }
  }

 private:
  static wire::CanFrame extended(std::uint32_t id, std::uint8_t size) {
    wire::CanFrame f;
    f.id = id;
    f.extended = true;
    f.size = size;
    return f;
  }
  wire::CanFrame filled(std::uint32_t id, std::uint8_t size) {
    wire::CanFrame f = extended(id, size);
    for (std::size_t k = 0; k < size; ++k) f.data[k] = byte();
    return f;
  }
  // Single, first and consecutive frames and flow controls; services that change the state are the likeliest.
  wire::CanFrame request(std::uint8_t node) {
    static const std::vector<Message> kLikely{{0x11, 0x01},
                                              {0x22, 0xFD, 0x0B},  // an answer of several frames
                                              {0x22, 0xF1, 0x90},
                                              {0x22, 0xFD, 0x10},
                                              {0x10, 0x03},
                                              {0x27, 0x01},
                                              {0x31, 0x01, 0x02, 0x03},
                                              {0x14, 0xFF, 0xFF, 0xFF},
                                              {0x35, 0x00, 0x44, 0, 2, 0, 0}};
    const bool all = below(10) == 0;
    wire::CanFrame f = filled(all ? wire::kFunctionalId : wire::physical_id(node, wire::kTesterAddress), 8);
    f.fd = below(3) == 0;
    if (f.fd) f.size = 64;
    switch (below(6)) {
      case 0:
        f.data[0] = static_cast<std::uint8_t>(0x30 | below(3));  // flow control: continue, wait, overflow
        f.data[2] = static_cast<std::uint8_t>(below(2) == 0 ? 0 : byte());
        break;
      case 1:
        f.data[0] = static_cast<std::uint8_t>(0x10 | below(3));
        break;
      case 2:
        f.data[0] = static_cast<std::uint8_t>(0x20 | below(16));
        break;
      default: {
        const Message& m = kLikely[below(static_cast<std::uint32_t>(kLikely.size()))];
        f.data[0] = static_cast<std::uint8_t>(m.size());
        std::ranges::copy(m, f.data.begin() + 1);
      }
    }
    return f;
  }
  wire::CanFrame update() {
    constexpr std::uint32_t kVersion = 0x7F000000;
    static const std::vector<std::uint8_t> kNext = image_for(1, kVersion, 1024, 2);
    const Bytes image = kNext;
    const wire::update::Offer offer{.slot = 1,
                                    .size_bytes = static_cast<std::uint32_t>(image.size()),
                                    .firmware_version = kVersion,
                                    .hardware_crc = crc32(wire::kPartNumber),
                                    .image_crc = crc32(image)};
    const std::uint32_t what = below(24);
    if (what < 4) return wire::update::encode_order(wire::update::encode_offer(offer, kSession)[what]);
    if (what < 12) {
      const std::uint32_t unit = below(static_cast<std::uint32_t>(image.size() / 8));
      return wire::update::encode_data(1, static_cast<std::uint16_t>(unit), image.subspan(unit * 8, 8));
    }
    const auto command = static_cast<wire::update::Command>(1 + below(11));
    const std::uint16_t session = below(8) == 0 ? static_cast<std::uint16_t>(below(3)) : kSession;
    return wire::update::encode_order(wire::update::order_to(command, session, crc32(kId)));
  }
  wire::CanFrame loader() {
    if (below(2) == 0) return filled(wire::loader::kDataId, 8);
    wire::CanFrame f = filled(wire::loader::kRequestId, 8);
    f.data[0] = static_cast<std::uint8_t>(below(8));
    if (f.data[0] == static_cast<std::uint8_t>(Command::kSelect))
      ByteWriter(std::span(f.data).subspan(1)).le32(crc32(kId));
    if (f.data[0] == static_cast<std::uint8_t>(Command::kErase)) f.data[1] = static_cast<std::uint8_t>(below(3));
    return f;
  }
  wire::CanFrame addresses() {
    if (below(3) == 0) return wire::who_is_there();
    return wire::encode_assignment(kId, static_cast<std::uint8_t>(1 + below(126)))[below(2)];
  }
  wire::CanFrame shared_frames() {
    if (below(2) == 0) return filled(0x18E3FF00 | byte(), 8);
    return wire::encode_lease({.reader = below(10), .lasts_10ms = static_cast<std::uint8_t>(below(4) * 50)});
  }
  wire::CanFrame icub() {
    wire::CanFrame f = filled(0, static_cast<std::uint8_t>(below(9)));
    f.extended = false;
    f.id = (below(2) == 0 ? 0x200U : 0x700U) | below(16);
    return f;
  }

  std::mt19937 dice_;
};

// TRISKIN_SEQUENCES=1000000 for the figure of docs/guarantees.md.
unsigned sequences() {
  const char* text = std::getenv("TRISKIN_SEQUENCES");
  return text != nullptr ? static_cast<unsigned>(std::strtoul(text, nullptr, 10)) : 4'000;
}

// A reset leaves every state: no update under way, default session, keys open.
void expect_state_after_power_up(Board& board) {
  board.room = true;
  board.run(
      16'500'000);  // The longest waits: loader 5 s, session of an update 10 s, an answer with all its waits 11 s.
  const std::uint8_t node = board.node();
  ASSERT_NE(node, 0) << "no application answers";
  ASSERT_EQ(board.ask(node, {0x11, 0x01}), (Message{0x51, 0x01}));
  board.run(100'000);
  EXPECT_EQ(board.ask(node, {0x22, 0xF1, 0x86}), (Message{0x62, 0xF1, 0x86, 0x01}));
  ASSERT_EQ(board.ask(node, {0x10, 0x03}).size(), 6U);
  EXPECT_EQ(board.ask(node, {0x27, 0x01}).size(), 6U);
  board.sent.clear();
  board.controller->receive(
      wire::update::encode_order(wire::update::order_to(wire::update::Command::kAsk, 0, crc32(kId))));
  board.run(1'000);
  std::optional<wire::update::State> state;
  for (const wire::CanFrame& f : board.sent) {
    if (const auto s = wire::update::decode_state(f.payload()); s && f.id == wire::claim_id(kId)) state = *s;
  }
  ASSERT_TRUE(state.has_value());
  EXPECT_EQ(state->phase, wire::update::Phase::kIdle);
  EXPECT_EQ(state->session, 0);
}

TEST(Progress, random_sequences_of_frames_never_stop_the_firmware) {
  constexpr std::uint32_t kSeed = 62;
  constexpr unsigned kPerBoard = 500;
  std::size_t frames = 0, resets = 0;
  for (unsigned first = 0; first < sequences(); first += kPerBoard) {
    Board board;
    Traffic traffic(kSeed + first);
    std::uint8_t node = 1;
    for (unsigned k = first; k < first + kPerBoard; ++k) {
      SCOPED_TRACE(testing::Message() << "seed " << kSeed + first << ", sequence " << k - first);
      if (traffic.below(16) == 0) board.room = !board.room;
      for (std::uint32_t n = 1 + traffic.below(6); n > 0; --n, ++frames) {
        board.controller->receive(traffic.frame(node));
        const std::uint64_t pause_us = traffic.below(4) == 0 ? traffic.below(30'000) : traffic.below(2) * 50;
        ASSERT_NO_THROW(board.run(pause_us));
      }
      // Rarely everybody is silent until a wait ends.
      constexpr std::array<std::uint32_t, 3> kWaits_us{1'100'000, 5'100'000, 10'100'000};
      ASSERT_NO_THROW(board.run(traffic.below(200) == 0 ? kWaits_us[traffic.below(3)] : traffic.below(3'000)));
      if (k % 50 == 0 && board.room) node = std::max<std::uint8_t>(board.node(), 1);
    }
    expect_state_after_power_up(board);
    ++resets;
    if (HasFailure()) return;
  }
  std::printf("%u sequences, %zu frames, seed %u: every one ended, and a reset left every state (%zu boards)\n",
              sequences(), frames, kSeed, resets);
}

// The answer to the second request waits for a flow control that never comes, while the restart of the first is due.
// The firmware once asked for that past moment for ever.
TEST(Progress, a_long_answer_does_not_hold_up_a_restart) {
  Board board;
  board.run(100'000);
  const auto single = [](std::initializer_list<std::uint8_t> bytes) {
    wire::IsoTp link(wire::physical_id(1, wire::kTesterAddress), wire::physical_id(wire::kTesterAddress, 1), 8);
    (void)link.send(Message(bytes), 0);
    return *link.transmit(0);
  };
  board.controller->receive(single({0x11, 0x01}));
  board.run(1'000);
  board.controller->receive(single({0x22, 0xF1, 0x8C}));  // The unique id needs three frames.
  board.run(1'000);
  board.sent.clear();
  board.controller->receive(wire::who_is_there());
  board.run(2'000);
  EXPECT_EQ(board.sent.size(), wire::kClaimFrames) << "5 ms have not passed: the application still answers";
  board.run(2'000);
  board.sent.clear();
  board.controller->receive(wire::who_is_there());
  board.run(1'000);
  EXPECT_TRUE(board.sent.empty()) << "5 ms have passed: the loader runs, which makes no claims";
}

// Nobody acknowledges on the bus, so the answer stays in the controller; it restarts a second later all the same.
TEST(Progress, an_answer_that_nobody_takes_delays_a_restart_by_a_second) {
  Board board;
  board.run(100'000);
  board.room = false;
  wire::IsoTp link(wire::physical_id(1, wire::kTesterAddress), wire::physical_id(wire::kTesterAddress, 1), 8);
  (void)link.send(Message{0x11, 0x01}, 0);
  board.controller->receive(*link.transmit(0));
  const auto claims = [&] {
    board.room = true;
    board.sent.clear();
    board.controller->receive(wire::who_is_there());
    board.controller->run_until(board.now_us);
    return std::ranges::count(board.sent, wire::claim_id(kId), &wire::CanFrame::id);
  };
  board.run(1'001'000);
  EXPECT_EQ(claims(), 0) << "the loader runs";
  board.run(100'000);
  EXPECT_EQ(claims(), 2) << "the application has started again";
}

}  // namespace
}  // namespace triskin::test
