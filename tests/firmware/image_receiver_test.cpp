// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the controller's part in a broadcast update, on a flash with the rules of the silicon.
#include "triskin/boot/image_receiver.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <set>

#include "firmware_image.hpp"
#include "flash_double.hpp"

namespace triskin::boot {
namespace {

using wire::update::Command;
using wire::update::Phase;

constexpr std::size_t kPages = 120;  // The slot has 240 KB, as on the board.
constexpr std::uint32_t kRuns = 0x00020000, kNew = 0x00030000;
constexpr std::uint16_t kSession = 0x1234;

using Area = test::FlashDouble<fw::FlashArea>;
using test::image_for;
using test::kSlotOrigins;

class Port final : public fw::CanPort {
 public:
  [[nodiscard]] bool fd() const override { return true; }
  bool send(const wire::CanFrame& f) override {
    if (room == 0) return false;
    --room;
    sent.push_back(f);
    return true;
  }
  [[nodiscard]] bool has_room() const override { return room > 0; }
  std::optional<wire::CanFrame> receive() override { return std::nullopt; }
  std::deque<wire::CanFrame> sent;
  int room = 1000;
};

class Restarts final : public fw::Restart {
 public:
  void restart() override { ++count; }
  std::optional<wire::ImageState> image_state() override { return std::nullopt; }
  int count = 0;
};

/// Slot 0 runs, and slot 1 is free.
class Receiver : public ::testing::Test {
 protected:
  Receiver() { put_running(true); }
  void put_running(bool confirmed) {
    const auto old = image_for(0, kRuns, 4096, 1);
    (void)slots.erase(0);
    (void)slots.program(0, 0, old);
    EXPECT_EQ(slots.commit(0, 4096, crc32(old)), Status::kOk);
    if (confirmed) slots.confirm(0);
  }
  wire::update::Offer offer_of(const std::vector<std::uint8_t>& image) const {
    return {.slot = 1,
            .size_bytes = static_cast<std::uint32_t>(image.size()),
            .firmware_version = kNew,
            .hardware_crc = crc32(wire::kPartNumber),
            .image_crc = crc32(image)};
  }
  void order(const wire::update::Order& o) {
    EXPECT_TRUE(receiver.handle(wire::update::encode_order(o), now_us));
    run();
  }
  void to_me(Command c, std::uint16_t session = kSession) {
    order(wire::update::order_to(c, session, crc32(self.unique_id)));
  }
  void to_all(Command c, std::uint16_t session = kSession) { order({c, session, {}}); }
  void offer(const wire::update::Offer& o, std::uint16_t session = kSession) {
    for (const auto& part : wire::update::encode_offer(o, session)) order(part);
  }
  void run() {
    for (int k = 0; k < 10'000 && receiver.next_event_us(now_us) <= now_us; ++k) {
      receiver.step(port, now_us);
      now_us += 10;
    }
    receiver.step(port, now_us);
  }
  void send(const std::vector<std::uint8_t>& image, const std::set<std::size_t>& lost = {}) {
    for (std::size_t u = 0; u < image.size() / 8; ++u) {
      if (lost.contains(u)) continue;
      ASSERT_FALSE(receiver.full());
      EXPECT_TRUE(receiver.handle(
          wire::update::encode_data(1, static_cast<std::uint16_t>(u), Bytes(image).subspan(8 * u, 8)), now_us));
      run();
    }
  }
  std::set<std::uint16_t> ask_missing() {
    port.sent.clear();
    to_me(Command::kMissing);
    std::set<std::uint16_t> units;
    for (const auto& f : port.sent)
      (void)wire::update::decode_missing(f.payload(), [&](std::uint16_t u) { units.insert(u); });
    EXPECT_EQ(wire::update::decode_state(port.sent.back().payload()).value().count, units.size());
    return units;
  }
  void take_part(const std::vector<std::uint8_t>& image) {
    offer(offer_of(image));
    to_me(Command::kJoin);
    ASSERT_EQ(receiver.state().phase, Phase::kJoined);
    to_all(Command::kErase);
    ASSERT_EQ(receiver.state().phase, Phase::kReceiving);
  }
  void expect_refused(Status why) {
    EXPECT_EQ(receiver.state().phase, Phase::kRefused);
    EXPECT_EQ(receiver.state().status, why);
    to_all(Command::kActivate);
    EXPECT_EQ(slots.choose(), 0);
    EXPECT_EQ(restarts.count, 0);
  }

  Area a{kPages}, b{kPages};
  SlotStore slots{{&a, &b}, kSlotOrigins};
  Restarts restarts;
  Port port;
  ImageReceiver::Self self{{1, 2, 3}, 0, kRuns};
  ImageReceiver receiver{slots, restarts, self};
  std::uint64_t now_us = 1'000'000;
};

TEST_F(Receiver, takes_an_image_asks_for_what_was_lost_and_starts_it) {
  const auto image = image_for(1, kNew, 6000, 7);
  take_part(image);
  // 6000 bytes take pages 0 … 2 and the page of records.
  EXPECT_EQ(b.operations(), 4);
  send(image, {3, 10, 400, 749});
  const auto missing = ask_missing();
  // Units 64 … 71 of the image read as erased, so a host omits them when it repeats missing units.
  EXPECT_EQ(missing, (std::set<std::uint16_t>{3, 10, 64, 65, 66, 67, 68, 69, 70, 71, 400, 749}));
  to_all(Command::kCheck);
  EXPECT_EQ(receiver.state().status, Status::kBadCrc);
  to_all(Command::kEnd);
  take_part(image);
  send(image);
  to_all(Command::kCheck);
  ASSERT_EQ(receiver.state().phase, Phase::kReady);
  EXPECT_EQ(slots.choose(), 0);
  to_all(Command::kActivate);
  now_us += 5'000;
  run();
  EXPECT_EQ(restarts.count, 1);
  EXPECT_EQ(slots.choose(), 1);
  EXPECT_EQ(slots.inspect(1).sequence, 2U);
  EXPECT_FALSE(slots.inspect(1).confirmed);
}

TEST_F(Receiver, units_in_FD_frames_and_units_that_come_twice) {
  const auto image = image_for(1, kNew, 4096, 7);
  take_part(image);
  for (int twice = 0; twice < 2; ++twice) {
    for (std::size_t at = 0; at < image.size(); at += 64) {
      EXPECT_TRUE(receiver.handle(
          wire::update::encode_data(1, static_cast<std::uint16_t>(at / 8), Bytes(image).subspan(at, 64)), now_us));
      EXPECT_TRUE(receiver.full());
      run();
    }
  }
  to_all(Command::kCheck);
  EXPECT_EQ(receiver.state().phase, Phase::kReady);
}

TEST_F(Receiver, says_what_runs) {
  to_me(Command::kAsk, 0);
  ASSERT_EQ(port.sent.size(), 3U);
  EXPECT_EQ(port.sent[0].id, wire::claim_id(self.unique_id));
  EXPECT_EQ(wire::update::decode_who(port.sent[0].payload()),
            (wire::update::Who{wire::update::kProtocol, 0, true, kRuns}));
  EXPECT_EQ(wire::update::decode_image(port.sent[1].payload()).value().record_crc, slots.inspect(0).record_crc);
  EXPECT_EQ(wire::update::decode_state(port.sent[2].payload()), wire::update::State{});
  port.sent.clear();
  order(wire::update::order_to(Command::kAsk, 0, 0xDEADBEEF));  // The order comes from another host.
  EXPECT_TRUE(port.sent.empty());
}

TEST_F(Receiver, refuses_what_it_cannot_use_and_writes_nothing) {
  const auto image = image_for(1, kNew, 4096, 7);
  const int before = b.operations();
  const auto refused = [&](auto change) {
    wire::update::Offer o = offer_of(image);
    change(o);
    offer(o);
    to_me(Command::kJoin);
    const Status s = receiver.state().status;
    expect_refused(s);
    to_all(Command::kErase);
    to_all(Command::kEnd);
    return s;
  };
  EXPECT_EQ(refused([](auto& o) { o.hardware_crc ^= 1; }), Status::kWrongTarget);
  EXPECT_EQ(refused([](auto& o) { o.firmware_version = kRuns - 1; }), Status::kOlder);
  EXPECT_EQ(refused([](auto& o) { o.size_bytes = 256; }), Status::kOutOfRange);
  EXPECT_EQ(refused([](auto& o) { o.size_bytes = 4097; }), Status::kOutOfRange);
  EXPECT_EQ(refused([](auto& o) { o.size_bytes = layout::kMaxFirmwareImageBytes + 8; }), Status::kOutOfRange);
  EXPECT_EQ(refused([](auto& o) { o.slot = 0; }), Status::kEmpty) << "an offer for the slot that runs is none for it";
  EXPECT_EQ(b.operations(), before);
  offer({.slot = 1,
         .may_be_older = true,
         .size_bytes = 4096,
         .firmware_version = 1,
         .hardware_crc = crc32(wire::kPartNumber)});
  to_me(Command::kJoin);
  EXPECT_EQ(receiver.state().phase, Phase::kJoined) << "older, and asked for";
}

TEST_F(Receiver, refuses_an_image_that_is_not_what_was_offered) {
  const auto refused = [&](const std::vector<std::uint8_t>& image) {
    take_part(image);
    send(image);
    to_all(Command::kCheck);
    const Status s = receiver.state().status;
    expect_refused(s);
    to_all(Command::kEnd);
    return s;
  };
  auto image = image_for(1, kNew, 4096, 7);
  image[layout::kLabelOffset + 8] ^= 1;
  EXPECT_EQ(refused(image), Status::kWrongTarget) << "other hardware";
  EXPECT_EQ(refused(image_for(0, kNew, 4096, 7)), Status::kWrongTarget) << "other slot";
  EXPECT_EQ(refused(image_for(1, kNew + 1, 4096, 7)), Status::kBadVersion);
  image = image_for(1, kNew, 4096, 7);
  image[layout::kLabelOffset] = 0;
  EXPECT_EQ(refused(image), Status::kBadMagic) << "no label";
  image = image_for(1, kNew, 4096, 7);
  image[7] = 0x20;  // The entry point is in RAM.
  EXPECT_EQ(refused(image), Status::kWrongTarget);
}

TEST_F(Receiver, a_foreign_tester_changes_nothing) {
  const auto image = image_for(1, kNew, 4096, 7);
  take_part(image);
  constexpr std::uint16_t kForeign = 0x4321;
  offer({.slot = 1, .size_bytes = 2048, .firmware_version = kNew, .hardware_crc = crc32(wire::kPartNumber)}, kForeign);
  to_me(Command::kJoin, kForeign);
  for (const Command c : {Command::kErase, Command::kCheck, Command::kActivate, Command::kEnd}) to_all(c, kForeign);
  EXPECT_EQ(receiver.state().session, kSession);
  EXPECT_EQ(receiver.state().phase, Phase::kReceiving);
  send(image);
  to_all(Command::kCheck);
  EXPECT_EQ(receiver.state().phase, Phase::kReady);
  to_all(Command::kActivate, kForeign);
  EXPECT_EQ(slots.choose(), 0);
  to_all(Command::kEnd);
  // Foreign data in the middle of ours damage the image, and this must be detected.
  take_part(image);
  const std::array<std::uint8_t, 8> foreign{9, 9, 9, 9, 9, 9, 9, 9};
  EXPECT_TRUE(receiver.handle(wire::update::encode_data(1, 100, foreign), now_us));
  run();
  send(image);
  to_all(Command::kCheck);
  expect_refused(Status::kBadCrc);
}

TEST_F(Receiver, ends_a_session_by_itself_after_ten_seconds_of_silence) {
  take_part(image_for(1, kNew, 4096, 7));
  now_us = receiver.next_event_us(now_us) - 1;
  receiver.step(port, now_us);
  EXPECT_EQ(receiver.state().phase, Phase::kReceiving);
  now_us += 1;
  receiver.step(port, now_us);
  EXPECT_EQ(receiver.state(), wire::update::State{});
}

TEST_F(Receiver, waits_until_the_firmware_that_runs_has_proved_itself) {
  put_running(false);
  offer(offer_of(image_for(1, kNew, 4096, 7)));
  to_me(Command::kJoin);
  expect_refused(Status::kUnproven);
  slots.confirm(0);
  to_me(Command::kJoin);
  EXPECT_EQ(receiver.state().phase, Phase::kJoined);
}

TEST_F(Receiver, answers_wait_for_room) {
  take_part(image_for(1, kNew, 4096, 7));
  port.sent.clear();
  port.room = 0;
  receiver.handle(
      wire::update::encode_order(wire::update::order_to(Command::kMissing, kSession, crc32(self.unique_id))), now_us);
  for (int k = 0; k < 100; ++k) receiver.step(port, now_us += 100);
  EXPECT_TRUE(port.sent.empty());
  EXPECT_EQ(receiver.next_event_us(now_us), now_us + 200) << "it looks for room, and does not ask for the same moment";
  port.room = 1000;
  now_us += 200;
  receiver.step(port, now_us);
  run();
  EXPECT_EQ(wire::update::decode_state(port.sent.back().payload()).value().count, 512);
}

TEST_F(Receiver, power_cut_in_any_operation_leaves_a_slot_that_starts) {
  const auto image = image_for(1, kNew, 2048, 7);
  const Area a_before = a, b_before = b;
  // There are two erases, 256 units less the gap of eight, and two units of the record.
  constexpr int kOperations = 2 + 256 - 8 + 2;
  int news = 0;
  for (const auto tear : {Area::Tear::kNothing, Area::Tear::kHalf, Area::Tear::kAll}) {
    for (int cut = 0; cut < kOperations; ++cut) {
      a = a_before;
      b = b_before;
      receiver.~ImageReceiver();
      new (&receiver) ImageReceiver(slots, restarts, self);
      b.cut_after(cut, tear);
      EXPECT_THROW(
          {
            take_part(image);
            send(image);
            to_all(Command::kCheck);
            to_all(Command::kActivate);
            now_us += 5'000;
            run();
          },
          sim::PowerLost)
          << cut;
      const int starts = slots.choose();
      ASSERT_GE(starts, 0) << cut;
      const bool is_new = cut == kOperations - 1 && tear == Area::Tear::kAll;
      EXPECT_EQ(starts, is_new ? 1 : 0) << cut;
      news += is_new ? 1 : 0;
    }
  }
  EXPECT_EQ(news, 1);
}

}  // namespace
}  // namespace triskin::boot
