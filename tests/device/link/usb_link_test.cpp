// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the USB link with devices that are plugged and unplugged; the real drivers are tested in the test machine
// (tests/vm).
#include "triskin/link/usb_link.hpp"

#include <gtest/gtest.h>

#include "triskin/wire/node_claim.hpp"

namespace triskin::link {
namespace {

// Answers every request with one byte more, and claims an address when the host asks who is there.
struct Board {
  std::string serial, place;
  std::uint8_t node = 1;
  bool plugged = true;
  std::mutex mutex;
  std::deque<wire::UsbPacket> out;
  std::vector<wire::CanFrame> got;
};

class Pipe final : public UsbPipe {
 public:
  explicit Pipe(Board& board) : board_(board) {}
  void write(const wire::UsbPacket& packet) override {
    const std::lock_guard lock(board_.mutex);
    if (!board_.plugged) throw DeviceError("gone");
    const auto frame = wire::from_usb(packet.used());
    ASSERT_TRUE(frame);
    board_.got.push_back(*frame);
    if (frame->id == wire::kWhoIsThereId) {
      for (const auto& f : wire::encode_claim({wire::UniqueId{board_.node}, board_.node, false}))
        board_.out.push_back(*wire::to_usb(f));
    } else if (frame->id == wire::physical_id(board_.node, wire::kTesterAddress)) {
      wire::CanFrame answer = *frame;
      answer.id = wire::physical_id(wire::kTesterAddress, board_.node);
      board_.out.push_back(*wire::to_usb(answer));
    }
  }
  std::size_t read(std::span<std::uint8_t> packets, int timeout_ms) override {
    for (int k = 0; k < timeout_ms; ++k) {
      {
        const std::lock_guard lock(board_.mutex);
        if (!board_.plugged) throw DeviceError("gone");
        if (!board_.out.empty()) {
          const auto packet = board_.out.front();
          board_.out.pop_front();
          std::ranges::copy(packet.used(), packets.begin());
          return packet.size;
        }
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return 0;
  }
  [[nodiscard]] std::string serial() const override { return board_.serial; }
  [[nodiscard]] std::string place() const override { return board_.place; }

 private:
  Board& board_;
};

struct Plugs {
  std::deque<Board> boards;
  bool refuses = false;  // Devices are listed, but none can be opened.
  std::atomic<bool> changed = false;
  Board& add(std::string serial, std::uint8_t node) {
    Board& b = boards.emplace_back();
    b.place = "port of " + serial;
    b.serial = std::move(serial);
    b.node = node;
    return b;
  }
  static void pull(Board& b) {
    const std::lock_guard lock(b.mutex);
    b.plugged = false;
  }
  void plug(Board& b) {
    const std::lock_guard lock(b.mutex);
    b.plugged = true;
    b.out.clear();
    changed = true;
  }
};

class Driver final : public UsbDriver {
 public:
  explicit Driver(Plugs& plugs) : plugs_(plugs) {}
  std::vector<std::unique_ptr<UsbPipe>> open(const std::string& serial,
                                             const std::vector<std::string>& places) override {
    std::vector<std::unique_ptr<UsbPipe>> pipes;
    if (plugs_.refuses && places.empty()) throw DeviceError("usb: the controller at 7-5 may not be opened");
    for (Board& b : plugs_.boards) {
      const std::lock_guard lock(b.mutex);
      if (b.plugged && (serial.empty() || serial == b.serial) && std::ranges::find(places, b.place) == places.end())
        pipes.push_back(std::make_unique<Pipe>(b));
    }
    return pipes;
  }
  [[nodiscard]] bool changed() override { return plugs_.changed.exchange(false); }
  [[nodiscard]] std::string name() const override { return "usb"; }

 private:
  Plugs& plugs_;
};

wire::CanFrame request_to(std::uint8_t node) {
  wire::CanFrame f;
  f.extended = true;
  f.id = wire::physical_id(node, wire::kTesterAddress);
  f.size = 2;
  return f;
}

// Returns the frames that arrive within a moment.
std::vector<wire::CanFrame> heard(UsbLink& link) {
  std::vector<wire::CanFrame> frames;
  const std::uint64_t until_us = link.now_us() + 150'000;
  while (const auto f = link.receive(until_us)) frames.push_back(*f);
  return frames;
}

TEST(UsbLink, a_request_goes_to_the_device_that_claimed_its_address) {
  Plugs plugs;
  Board &one = plugs.add("AA", 1), &two = plugs.add("BB", 2);
  UsbLink link(std::make_unique<Driver>(plugs), "");
  link.send(wire::who_is_there());
  EXPECT_EQ(heard(link).size(), 4U);
  EXPECT_NE(link.wire_of(1), link.wire_of(2));
  link.send(request_to(2));
  ASSERT_EQ(heard(link).size(), 1U);
  EXPECT_EQ(one.got.size(), 1U);
  EXPECT_EQ(two.got.size(), 2U);
  link.send(request_to(3));  // Nobody has claimed the address, so everybody receives the frame.
  EXPECT_TRUE(heard(link).empty());
  EXPECT_EQ(one.got.size(), 2U);
}

TEST(UsbLink, an_unplugged_device_is_named_and_the_others_go_on) {
  Plugs plugs;
  Board& one = plugs.add("AA", 1);
  plugs.add("BB", 2);
  UsbLink link(std::make_unique<Driver>(plugs), "");
  link.send(wire::who_is_there());
  (void)heard(link);
  Plugs::pull(one);
  EXPECT_TRUE(heard(link).empty());
  try {
    link.send(request_to(1));
    FAIL() << "sent to nobody";
  } catch (const Unreachable& e) {
    EXPECT_NE(std::string(e.what()).find("AA was unplugged"), std::string::npos) << e.what();
  }
  link.send(request_to(2));
  EXPECT_EQ(heard(link).size(), 1U);
}

// Reading and sending both find out, in either order, and a device that is pulled at once may not have told its number.
TEST(UsbLink, unplugged_devices_are_named_once_each) {
  Plugs plugs;
  Board *one = &plugs.add("BB", 1), *two = &plugs.add("AA", 2), *unread = &plugs.add("", 3);
  UsbLink link(std::make_unique<Driver>(plugs), "");
  link.send(wire::who_is_there());
  (void)heard(link);
  for (Board* b : {one, two, unread}) Plugs::pull(*b);
  // Each device has a thread of its own that finds out when the computer lets it run.
  for (int k = 0; k < 100 && link.trouble().find("AA, BB") == std::string::npos; ++k) {
    try {
      link.send(request_to(1));
      (void)heard(link);
    } catch (const Unreachable&) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  EXPECT_EQ(link.trouble(), "controllers AA, BB were unplugged; plug them in and run the command again");
}

TEST(UsbLink, the_last_one_gone_is_the_end_until_it_is_back) {
  Plugs plugs;
  Board& one = plugs.add("AA", 1);
  UsbLink link(std::make_unique<Driver>(plugs), "AA");
  Plugs::pull(one);
  EXPECT_THROW((void)heard(link), Unreachable);
  EXPECT_THROW(link.send(request_to(1)), Unreachable);
  EXPECT_THROW(link.reconnect(), Unreachable);
  plugs.plug(one);
  link.reconnect();
  EXPECT_TRUE(link.trouble().empty());
  link.send(request_to(1));
  EXPECT_EQ(heard(link).size(), 1U);
}

// A flash waits for a link that is Unreachable, and ends for any other error.
TEST(UsbLink, a_device_that_leaves_or_returns_and_cannot_be_opened_is_away) {
  Plugs plugs;
  Board& one = plugs.add("AA", 1);
  UsbLink link(std::make_unique<Driver>(plugs), "");
  plugs.refuses = true;
  Plugs::pull(one);
  try {
    (void)link.receive(link.now_us() + 2'000'000);
    FAIL() << "the device is gone";
  } catch (const Unreachable& e) {
    EXPECT_NE(std::string(e.what()).find("AA was unplugged"), std::string::npos) << e.what();
  }
  EXPECT_THROW(link.reconnect(), Unreachable);
  plugs.refuses = false;
  plugs.plug(one);
  link.reconnect();
  link.send(wire::who_is_there());
  EXPECT_EQ(heard(link).size(), 2U);
  plugs.refuses = true;
  EXPECT_THROW(UsbLink(std::make_unique<Driver>(plugs), ""), DeviceError);  // Nobody had it open: permissions matter.
}

TEST(UsbLink, a_device_that_is_plugged_in_joins) {
  Plugs plugs;
  plugs.add("AA", 1);
  Board& two = plugs.add("BB", 2);
  Plugs::pull(two);
  UsbLink link(std::make_unique<Driver>(plugs), "");
  plugs.plug(two);
  (void)heard(link);  // The system reports the change.
  link.send(wire::who_is_there());
  EXPECT_EQ(heard(link).size(), 4U);
}

TEST(UsbLink, nobody_there_is_an_error_with_the_remedy) {
  Plugs plugs;
  EXPECT_THROW(UsbLink(std::make_unique<Driver>(plugs), ""), Unreachable);
}

}  // namespace
}  // namespace triskin::link
