// SPDX-License-Identifier: GPL-3.0-or-later
// On each way into a slot (broadcast, loader, DFU) each wrong image is refused with its reason, and what ran before is
// what starts. docs/decisions.md, 0041, says which way compares versions.
#include <gtest/gtest.h>

#include "firmware_image.hpp"
#include "flash_double.hpp"
#include "support/package_bytes.hpp"
#include "triskin/boot/dfu_device.hpp"
#include "triskin/boot/image_receiver.hpp"
#include "triskin/boot/loader.hpp"

namespace triskin::boot {
namespace {

using Area = test::FlashDouble<fw::FlashArea>;

constexpr std::size_t kPages = 4, kImageBytes = 1024;
constexpr std::uint32_t kRuns = 0x00020000, kNew = 0x00030000, kOld = 0x00010000;
constexpr wire::UniqueId kId{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
constexpr std::uint8_t kDfuIdle = 2, kDfuDownloadIdle = 5, kDfuError = 10;

/// Slot 0 runs a confirmed image, slot 1 is free.
struct Board {
  Area a{kPages}, b{kPages};
  SlotStore slots{{&a, &b}, test::kSlotOrigins};
  Board() {
    const auto image = test::image_for(0, kRuns, kImageBytes, 1);
    (void)slots.erase(0);
    for (std::size_t at = 0; at < image.size(); at += 8)
      (void)slots.program(0, static_cast<std::uint32_t>(at), Bytes(image).subspan(at, 8));
    EXPECT_EQ(slots.commit(0, kImageBytes, crc32(image)), Status::kOk);
    slots.confirm(0);
  }
};

class Port final : public fw::CanPort {
 public:
  [[nodiscard]] bool fd() const override { return false; }
  bool send(const wire::CanFrame& f) override {
    sent.push_back(f);
    return true;
  }
  std::optional<wire::CanFrame> receive() override { return std::nullopt; }
  std::vector<wire::CanFrame> sent;
};

class NoRestart final : public fw::Restart {
 public:
  void restart() override {}
  std::optional<wire::ImageState> image_state() override { return std::nullopt; }
};

struct Case {
  const char* name;
  std::vector<std::uint8_t> package;
  std::size_t lost_bytes;  ///< at the end of the image
  Status by_broadcast, by_loader;
  std::uint8_t by_dfu;  ///< status of DFU 1.1, 6.1.2: 0 OK, 1 errTARGET, 9 errNOTDONE, 10 errFIRMWARE
};

std::vector<std::uint8_t> package_with(std::uint32_t at, std::uint32_t value) {
  auto bytes = test::package_bytes({.fill = 2, .version = kNew});
  const std::size_t image = layout::kPackageHeadBytes + kImageBytes;
  for (std::size_t k = 0; k < 4; ++k) bytes[image + at + k] = static_cast<std::uint8_t>(value >> (8 * k));
  return bytes;
}

std::vector<Case> cases() {
  auto foreign = wire::kPartNumber;
  foreign[7] = '2';
  return {
      {"right", test::package_bytes({.fill = 2, .version = kNew}), 0, Status::kOk, Status::kOk, 0},
      // Loader and DFU are the way back when no application answers, so they take an older one.
      {"older", test::package_bytes({.fill = 2, .version = kOld}), 0, Status::kOlder, Status::kOk, 0},
      {"foreign hardware", test::package_bytes({.fill = 2, .version = kNew, .hardware = foreign}), 0,
       Status::kWrongTarget, Status::kWrongTarget, 1},
      {"unlabelled", test::package_bytes({.fill = 2, .labelled = false, .version = kNew}), 0, Status::kBadMagic,
       Status::kBadMagic, 10},
      {"truncated", test::package_bytes({.fill = 2, .version = kNew}), 64, Status::kBadCrc, Status::kBadCrc, 9},
      {"other chip", package_with(0, 0x10004000), 0, Status::kWrongTarget, Status::kWrongTarget, 1},
      {"other slot", package_with(layout::kLabelOffset + 20, test::kSlotOrigins[0]), 0, Status::kWrongTarget,
       Status::kWrongTarget, 1},
  };
}

Bytes image_of(const Case& c) {
  return Bytes(c.package).subspan(layout::kPackageHeadBytes + kImageBytes, kImageBytes);
}

// The offer is the best that a host can make of the image, so that only the image itself can be refused.
Status by_broadcast(Board& board, const Case& c) {
  using wire::update::Command;
  using wire::update::Phase;
  constexpr std::uint16_t kSession = 0x1234;
  Port port;
  NoRestart restart;
  ImageReceiver receiver(board.slots, restart, {kId, 0, kRuns});
  std::uint64_t now_us = 0;
  const auto give = [&](const wire::CanFrame& frame) {
    (void)receiver.handle(frame, now_us);
    for (int k = 0; k < 1000 && receiver.next_event_us(now_us) <= now_us; ++k) receiver.step(port, now_us);
    now_us += 100;
  };
  const auto order = [&](const wire::update::Order& o) { give(wire::update::encode_order(o)); };
  const Bytes image = image_of(c);
  const wire::update::Offer offer{.slot = 1,
                                  .size_bytes = kImageBytes,
                                  .firmware_version = kNew,
                                  .hardware_crc = crc32(wire::kPartNumber),
                                  .image_crc = crc32(image)};
  for (const auto& part : wire::update::encode_offer(offer, kSession)) order(part);
  order(wire::update::order_to(Command::kJoin, kSession, crc32(kId)));
  EXPECT_EQ(receiver.state().phase, Phase::kJoined) << c.name;
  order({Command::kErase, kSession, {}});
  for (std::size_t u = 0; u < (kImageBytes - c.lost_bytes) / 8; ++u)
    give(wire::update::encode_data(1, static_cast<std::uint16_t>(u), image.subspan(8 * u, 8)));
  order({Command::kCheck, kSession, {}});
  if (receiver.state().phase == Phase::kRefused) return receiver.state().status;
  EXPECT_EQ(receiver.state().phase, Phase::kReady) << c.name;
  order({Command::kActivate, kSession, {}});
  return Status::kOk;
}

Status by_loader(Board& board, const Case& c) {
  using wire::loader::Command;
  Port port;
  Loader loader(board.slots, port, kId);
  const auto command = [&](Command what, std::initializer_list<std::uint8_t> arguments) {
    wire::CanFrame f;
    f.id = wire::loader::kRequestId;
    f.extended = true;
    f.data[0] = static_cast<std::uint8_t>(what);
    std::ranges::copy(arguments, f.data.begin() + 1);
    f.size = static_cast<std::uint8_t>(1 + arguments.size());
    (void)loader.handle(f, 0);
    EXPECT_FALSE(port.sent.empty());
    return port.sent.empty() ? Status::kEmpty : static_cast<Status>(port.sent.back().data[1]);
  };
  const auto byte = [](std::uint32_t value, int k) { return static_cast<std::uint8_t>(value >> (8 * k)); };
  const std::uint32_t id = crc32(kId), crc = crc32(image_of(c));
  EXPECT_EQ(command(Command::kSelect, {byte(id, 0), byte(id, 1), byte(id, 2), byte(id, 3)}), Status::kOk);
  EXPECT_EQ(command(Command::kErase, {0}), Status::kWrongTarget) << "the slot that would start";
  EXPECT_EQ(command(Command::kErase, {1}), Status::kOk);
  for (std::size_t at = 0; at < kImageBytes - c.lost_bytes; at += 8) {
    wire::CanFrame f;
    f.id = wire::loader::kDataId;
    f.extended = true;
    f.size = 8;
    std::ranges::copy(image_of(c).subspan(at, 8), f.data.begin());
    (void)loader.handle(f, 0);
  }
  return command(Command::kCommit, {byte(kImageBytes, 0), byte(kImageBytes, 1), byte(kImageBytes, 2), byte(crc, 0),
                                    byte(crc, 1), byte(crc, 2), byte(crc, 3)});
}

/// Requests of DFU 1.1, chapter 3.
class Dfu {
 public:
  explicit Dfu(SlotStore& slots) : device(slots, kId) {}
  bool download(Bytes block) {
    return device.control({0x21, 1, number_++, 0, static_cast<std::uint16_t>(block.size())}, block).has_value();
  }
  std::vector<std::uint8_t> status() {
    const auto reply = device.control({0xA1, 3, 0, 0, 6}, {});
    EXPECT_TRUE(reply);
    return {reply->begin(), reply->end()};
  }
  std::vector<std::uint8_t> state() {
    const auto reply = device.control({0xA1, 5, 0, 0, 1}, {});
    EXPECT_TRUE(reply);
    return {reply->begin(), reply->end()};
  }
  DfuDevice device;

 private:
  std::uint16_t number_ = 0;
};

std::uint8_t by_dfu(Board& board, const Case& c) {
  constexpr std::size_t kBlock = 512;
  Dfu dfu(board.slots);
  const Bytes bytes = Bytes(c.package).first(c.package.size() - c.lost_bytes);
  for (std::size_t at = 0; at < bytes.size(); at += kBlock) {
    EXPECT_TRUE(dfu.download(bytes.subspan(at, std::min(kBlock, bytes.size() - at)))) << c.name;
    EXPECT_EQ(dfu.status().at(4), kDfuDownloadIdle) << c.name;
  }
  EXPECT_TRUE(dfu.download({})) << c.name;
  const auto status = dfu.status();
  EXPECT_EQ(dfu.device.committed(), c.by_dfu == 0) << c.name;
  EXPECT_EQ(status.at(4), c.by_dfu == 0 ? kDfuIdle : kDfuError) << c.name;
  EXPECT_EQ(dfu.state(), std::vector{status.at(4)}) << "GETSTATE has one byte";
  return status.at(0);
}

TEST(ImagePaths, each_refuses_each_wrong_image_with_its_reason_and_keeps_what_runs) {
  for (const Case& c : cases()) {
    Board sent, loaded, downloaded;
    EXPECT_EQ(by_broadcast(sent, c), c.by_broadcast) << c.name;
    EXPECT_EQ(by_loader(loaded, c), c.by_loader) << c.name;
    EXPECT_EQ(by_dfu(downloaded, c), c.by_dfu) << c.name;
    EXPECT_EQ(sent.slots.choose(), c.by_broadcast == Status::kOk ? 1 : 0) << c.name;
    EXPECT_EQ(loaded.slots.choose(), c.by_loader == Status::kOk ? 1 : 0) << c.name;
    EXPECT_EQ(downloaded.slots.choose(), c.by_dfu == 0 ? 1 : 0) << c.name;
  }
}

TEST(DfuDevice, detaching_makes_it_leave) {
  Board board;
  Dfu dfu(board.slots);
  EXPECT_FALSE(dfu.device.wants_to_reconnect());
  EXPECT_TRUE(dfu.device.control({0x21, 0, 1000, 0, 0}, {}).has_value());
  EXPECT_TRUE(dfu.device.wants_to_reconnect());
}

// 04 errERASE, 03 errWRITE.
TEST(DfuDevice, a_flash_that_refuses_is_named) {
  const auto package = test::package_bytes({.fill = 2, .version = kNew});
  {
    Board board;
    Dfu dfu(board.slots);
    board.b.refuse(true);
    EXPECT_FALSE(dfu.download(Bytes(package).first(512)));
    EXPECT_EQ(dfu.status(), (std::vector<std::uint8_t>{4, 35, 0, 0, kDfuError, 0})) << "the page of records";
  }
  {
    Board board;
    Dfu dfu(board.slots);
    ASSERT_TRUE(dfu.download(Bytes(package).first(32)));  // The head; the records are erased.
    EXPECT_EQ(dfu.status().at(4), kDfuDownloadIdle);
    ASSERT_TRUE(dfu.download(Bytes(package).subspan(32, kImageBytes)));  // The image of the slot that runs is left out.
    EXPECT_EQ(dfu.status().at(4), kDfuDownloadIdle);
    board.b.refuse(true);
    EXPECT_FALSE(dfu.download(Bytes(package).subspan(32 + kImageBytes, 512)));
    EXPECT_EQ(dfu.status().at(0), 4) << "a page of the image";
    EXPECT_EQ(dfu.status().at(4), kDfuError);
  }
  Board board;
  Dfu dfu(board.slots);
  ASSERT_TRUE(dfu.download(Bytes(package).first(32 + kImageBytes + 512)));
  EXPECT_EQ(dfu.status().at(4), kDfuDownloadIdle);
  board.b.refuse(true);  // The page is erased by now.
  EXPECT_FALSE(dfu.download(Bytes(package).subspan(32 + kImageBytes + 512)));
  EXPECT_EQ(dfu.status().at(0), 3);
}

// An image of slot `slot` with this sequence; `starts` attempts without a confirmation.
void put(Board& board, int slot, std::uint32_t sequence, int starts, bool confirmed) {
  const auto image = test::image_for(slot, kRuns, kImageBytes, 3);
  ASSERT_EQ(board.slots.erase(slot), Status::kOk);
  for (std::size_t at = 0; at < image.size(); at += 8)
    ASSERT_EQ(board.slots.program(slot, static_cast<std::uint32_t>(at), Bytes(image).subspan(at, 8)), Status::kOk);
  ASSERT_TRUE(board.slots.write_record(slot, sequence, kImageBytes, layout::slot_crc(sequence, image)));
  for (int k = 0; k < starts; ++k) ASSERT_TRUE(board.slots.note_start(slot));
  if (confirmed) board.slots.confirm(slot);
}

TEST(SlotStore, starts_the_newest_that_may_start_and_else_the_newest_that_is_whole) {
  struct Slot {
    std::uint32_t sequence;
    int starts;
    bool confirmed;
  };
  struct Row {
    const char* what;
    Slot a, b;
    int chosen;
  };
  const Row rows[] = {
      {"both confirmed: the newer", {1, 1, true}, {2, 1, true}, 1},
      {"both confirmed, the other way round", {3, 1, true}, {2, 1, true}, 0},
      {"the newer has never run", {1, 1, true}, {2, 0, false}, 1},
      {"the newer was tried twice", {1, 1, true}, {2, 2, false}, 1},
      {"the newer was tried three times: the older", {1, 1, true}, {2, 3, false}, 0},
      {"the newer was tried three times, in slot A", {2, 3, false}, {1, 1, true}, 1},
      {"neither may start: the newer, not none", {1, 3, false}, {2, 3, false}, 1},
      {"neither may start, the other way round", {2, 3, false}, {1, 3, false}, 0},
      {"confirmed at the third start", {1, 1, true}, {2, 3, true}, 1},
  };
  for (const Row& row : rows) {
    Board board;
    put(board, 0, row.a.sequence, row.a.starts, row.a.confirmed);
    put(board, 1, row.b.sequence, row.b.starts, row.b.confirmed);
    EXPECT_EQ(board.slots.choose(), row.chosen) << row.what;
  }
  Board empty;
  ASSERT_EQ(empty.slots.erase(0), Status::kOk);
  EXPECT_EQ(empty.slots.choose(), -1);
}

}  // namespace
}  // namespace triskin::boot
