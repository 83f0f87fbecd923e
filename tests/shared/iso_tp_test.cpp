// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/wire/iso_tp.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <numeric>

#include "triskin/wire/uds.hpp"
#include "vectors/vector_file.hpp"

namespace triskin::wire {
namespace {

using Event = IsoTp::Event;
using Message = std::vector<std::uint8_t>;

constexpr std::uint32_t kToNode = physical_id(5, kTesterAddress), kToTester = physical_id(kTesterAddress, 5);
static_assert(kToNode == 0x18DA05F1 && kToTester == 0x18DAF105);

IsoTp tester(std::uint8_t bytes = 8) {
  return {kToNode, kToTester, bytes};
}
IsoTp node(std::uint8_t bytes = 8) {
  return {kToTester, kToNode, bytes};
}

Message counting(std::size_t size) {
  Message m(size);
  std::iota(m.begin(), m.end(), std::uint8_t{0});
  return m;
}

Message received(const IsoTp& end) {
  return {end.message().begin(), end.message().end()};
}

CanFrame frame(std::initializer_list<std::uint8_t> bytes) {
  CanFrame f;
  f.id = kToNode;
  f.extended = true;
  for (const std::uint8_t b : bytes) f.data[f.size++] = b;
  return f;
}

TEST(IsoTpVectors, FramesAsTheFileSays) {
  for (const test::Vector& v : test::read_vectors("iso_tp.txt")) {
    SCOPED_TRACE(v.name);
    const auto bytes = static_cast<std::uint8_t>(v.number("bytes"));
    IsoTp a = tester(bytes), b = node(bytes);
    const Message message = test::hex_bytes(v.one("message"));
    ASSERT_EQ(a.send(message, 0), Status::kOk);
    Event last = Event::kNone;
    for (const auto& [key, value] : v.lines) {
      if (key != ">" && key != "<") continue;
      const auto sent = (key == ">" ? a : b).transmit(0);
      ASSERT_TRUE(sent) << value;
      EXPECT_EQ(sent->id, key == ">" ? kToNode : kToTester);
      EXPECT_EQ(sent->fd, bytes == 64);
      EXPECT_EQ(Message(sent->payload().begin(), sent->payload().end()), test::hex_bytes(value));
      if (key == ">")
        last = b.receive(*sent, 0);
      else
        EXPECT_EQ(a.receive(*sent, 0), Event::kNone);
    }
    EXPECT_EQ(last, Event::kReceived);
    EXPECT_EQ(received(b), message);
    EXPECT_FALSE(a.transmit(0));
    EXPECT_FALSE(a.sending());
  }
}

// Passes frames until both ends are silent; `drop` decides by frame number which ones get lost.
template <class Lost>
Event converse(IsoTp& a, IsoTp& b, Lost lost, std::uint64_t& now_us) {
  int number = 0;
  for (int idle = 0; idle < 3; ++idle) {
    for (auto [from, to] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
      while (const auto f = from->transmit(now_us)) {
        idle = 0;
        if (lost(number++)) continue;
        const Event e = to->receive(*f, now_us);
        if (e == Event::kReceived) return e;
      }
    }
    now_us += 1'000;
  }
  return Event::kNone;
}

TEST(IsoTp, EveryLengthArrives) {
  for (const std::uint8_t bytes : {std::uint8_t{8}, std::uint8_t{64}}) {
    for (std::size_t size = 1; size <= IsoTp::kCapacity; ++size) {
      IsoTp a = tester(bytes), b = node(bytes);
      const Message m = counting(size);
      ASSERT_EQ(a.send(m, 0), Status::kOk);
      std::uint64_t now = 0;
      ASSERT_EQ(converse(a, b, [](int) { return false; }, now), Event::kReceived) << size;
      ASSERT_EQ(received(b), m) << size;
    }
  }
}

TEST(IsoTp, LongerOrEmptyMessagesAreRefused) {
  IsoTp a = tester();
  EXPECT_EQ(a.send({}, 0), Status::kNoSpace);
  EXPECT_EQ(a.send(counting(IsoTp::kCapacity + 1), 0), Status::kNoSpace);
  EXPECT_EQ(a.send(counting(20), 0), Status::kOk);
  EXPECT_EQ(a.send(counting(3), 0), Status::kOutOfRange);  // The sender is busy.
}

TEST(IsoTp, ALostFrameNeverGivesAWrongMessage) {
  for (int lost = 0; lost < 7; ++lost) {
    IsoTp a = tester(), b = node();
    // There are a first frame, flow control and five consecutive frames.
    ASSERT_EQ(a.send(counting(40), 0), Status::kOk);
    std::uint64_t now = 0;
    EXPECT_EQ(converse(a, b, [&](int n) { return n == lost; }, now), Event::kNone) << "frame " << lost;
    now += IsoTp::kTimeout_us + 1;
    (void)a.tick(now);
    (void)b.tick(now);
    EXPECT_FALSE(a.sending());
    ASSERT_EQ(a.send(counting(9), now), Status::kOk);  // The connection works again.
    EXPECT_EQ(converse(a, b, [](int) { return false; }, now), Event::kReceived);
    EXPECT_EQ(received(b), counting(9));
  }
}

TEST(IsoTp, DuplicatedAndReorderedFramesEndTheMessage) {
  IsoTp b = node();
  const CanFrame first = frame({0x10, 20, 0, 1, 2, 3, 4, 5}), one = frame({0x21, 6, 7, 8, 9, 10, 11, 12}),
                 two = frame({0x22, 13, 14, 15, 16, 17, 18, 19});
  EXPECT_EQ(b.receive(first, 0), Event::kNone);
  EXPECT_EQ(b.receive(one, 0), Event::kNone);
  EXPECT_EQ(b.receive(one, 0), Event::kFailed);  // The frame is duplicated.
  EXPECT_EQ(b.receive(two, 0), Event::kNone);    // The frame belongs to no transfer any more.
  EXPECT_EQ(b.receive(first, 0), Event::kNone);
  EXPECT_EQ(b.receive(two, 0), Event::kFailed);  // The frames are reordered.
  EXPECT_EQ(b.receive(first, 0), Event::kNone);
  EXPECT_EQ(b.receive(first, 0), Event::kNone);  // A first frame starts over.
  EXPECT_EQ(b.receive(one, 0), Event::kNone);
  EXPECT_EQ(b.receive(two, 0), Event::kReceived);
  EXPECT_EQ(received(b), counting(20));
}

TEST(IsoTp, ShortFramesAreAcceptedOnlyAtTheEnd) {
  IsoTp b = node();
  EXPECT_EQ(b.receive(frame({0x03, 0x22, 0xF1, 0x90}), 0), Event::kReceived);  // This single frame is unpadded.
  EXPECT_EQ(received(b), (Message{0x22, 0xF1, 0x90}));
  const CanFrame first = frame({0x10, 15, 0, 1, 2, 3, 4, 5});
  EXPECT_EQ(b.receive(first, 0), Event::kNone);
  EXPECT_EQ(b.receive(frame({0x21, 6, 7, 8}), 0), Event::kFailed);  // The frame interrupts the first message.
  EXPECT_EQ(b.receive(first, 0), Event::kNone);
  EXPECT_EQ(b.receive(frame({0x21, 6, 7, 8, 9, 10, 11, 12}), 0), Event::kNone);
  EXPECT_EQ(b.receive(frame({0x22, 13, 14}), 0), Event::kReceived);  // This frame completes the message.
  EXPECT_EQ(received(b), counting(15));
}

TEST(IsoTp, NonsenseIsIgnored) {
  IsoTp b = node();
  EXPECT_EQ(b.receive(frame({}), 0), Event::kNone);
  EXPECT_EQ(b.receive(frame({0x00}), 0), Event::kNone);                       // The length is 0.
  EXPECT_EQ(b.receive(frame({0x05, 1, 2}), 0), Event::kNone);                 // The frame announces 5 bytes but has 2.
  EXPECT_EQ(b.receive(frame({0x10, 7, 0, 1, 2, 3, 4, 5}), 0), Event::kNone);  // 7 bytes would be a single frame.
  EXPECT_EQ(b.receive(frame({0x10, 20, 0, 1}), 0), Event::kNone);             // The first frame is cut off.
  EXPECT_EQ(b.receive(frame({0x21, 6, 7, 8, 9, 10, 11, 12}), 0), Event::kNone);  // No transfer is under way.
  EXPECT_EQ(b.receive(frame({0x30, 0, 0}), 0), Event::kNone);                    // The receiver is not sending.
  EXPECT_EQ(b.receive(frame({0x40, 1, 2, 3}), 0), Event::kNone);                 // No such frame exists.
  EXPECT_FALSE(b.transmit(0));
}

TEST(IsoTp, TooLongAMessageIsAnsweredWithOverflow) {
  IsoTp b = node();
  EXPECT_EQ(b.receive(frame({0x14, 0x01, 0, 1, 2, 3, 4, 5}), 0), Event::kNone);  // The length is 1025 bytes.
  EXPECT_EQ(b.transmit(0)->data[0], 0x32);
  EXPECT_EQ(b.receive(frame({0x10, 0, 0, 1, 0, 0, 4, 5}), 0), Event::kNone);  // The escaped length is 65536 bytes.
  EXPECT_EQ(b.transmit(0)->data[0], 0x32);
  IsoTp a = tester();
  ASSERT_EQ(a.send(counting(30), 0), Status::kOk);
  ASSERT_TRUE(a.transmit(0));
  EXPECT_EQ(a.receive(frame({0x32, 0, 0}), 0), Event::kFailed);
  EXPECT_FALSE(a.sending());
}

TEST(IsoTp, BlockSizeAndGapAreKept) {
  IsoTp a = tester();
  ASSERT_EQ(a.send(counting(6 + 5 * 7), 0), Status::kOk);
  ASSERT_TRUE(a.transmit(0));
  EXPECT_FALSE(a.transmit(0));                                      // The sender waits for flow control.
  EXPECT_EQ(a.receive(frame({0x30, 2, 0xF3}), 100), Event::kNone);  // Two frames follow, 300 µs apart.
  EXPECT_TRUE(a.transmit(100));
  EXPECT_FALSE(a.transmit(399));
  EXPECT_EQ(a.next_event_us(), 400U);
  EXPECT_TRUE(a.transmit(400));
  EXPECT_FALSE(a.transmit(10'000));                                  // The block is full.
  EXPECT_EQ(a.receive(frame({0x30, 0, 20}), 10'000), Event::kNone);  // The rest follows, 20 ms apart.
  EXPECT_TRUE(a.transmit(10'000));
  EXPECT_FALSE(a.transmit(29'999));
  EXPECT_TRUE(a.transmit(30'000));
  EXPECT_TRUE(a.transmit(50'000));
  EXPECT_FALSE(a.sending());
}

TEST(IsoTp, AReservedGapMeansTheLongest) {
  IsoTp a = tester();
  ASSERT_EQ(a.send(counting(30), 0), Status::kOk);
  ASSERT_TRUE(a.transmit(0));
  EXPECT_EQ(a.receive(frame({0x30, 0, 0xFA}), 0), Event::kNone);
  EXPECT_TRUE(a.transmit(0));
  EXPECT_FALSE(a.transmit(126'999));
  EXPECT_TRUE(a.transmit(127'000));
}

TEST(IsoTp, WaitingHasAnEnd) {
  IsoTp a = tester();
  ASSERT_EQ(a.send(counting(30), 0), Status::kOk);
  ASSERT_TRUE(a.transmit(0));
  for (int k = 0; k < IsoTp::kMaxWaits; ++k) EXPECT_EQ(a.receive(frame({0x31, 0, 0}), 0), Event::kNone);
  EXPECT_EQ(a.receive(frame({0x31, 0, 0}), 0), Event::kFailed);
  ASSERT_EQ(a.send(counting(30), 0), Status::kOk);
  ASSERT_TRUE(a.transmit(0));
  EXPECT_EQ(a.tick(IsoTp::kTimeout_us), Event::kNone);
  EXPECT_EQ(a.next_event_us(), IsoTp::kTimeout_us + 1);
  EXPECT_EQ(a.tick(IsoTp::kTimeout_us + 1), Event::kFailed);
  EXPECT_EQ(a.next_event_us(), UINT64_MAX);
}

TEST(IsoTp, AWaitRenewsTheDeadline) {
  IsoTp a = tester();
  ASSERT_EQ(a.send(counting(30), 0), Status::kOk);
  ASSERT_TRUE(a.transmit(0));
  EXPECT_EQ(a.receive(frame({0x31, 0, 0}), 900'000), Event::kNone);
  EXPECT_EQ(a.next_event_us(), 1'900'001U);
  EXPECT_EQ(a.tick(1'900'000), Event::kNone);
  EXPECT_EQ(a.receive(frame({0x30, 0, 0}), 1'900'000), Event::kNone);
  EXPECT_TRUE(a.transmit(1'900'000)) << "the message goes on";
}

TEST(IsoTp, ASilentSenderIsGivenUp) {
  IsoTp b = node();
  EXPECT_EQ(b.receive(frame({0x10, 20, 0, 1, 2, 3, 4, 5}), 0), Event::kNone);
  EXPECT_TRUE(b.transmit(0));
  EXPECT_EQ(b.tick(IsoTp::kTimeout_us + 1), Event::kFailed);
  EXPECT_EQ(b.receive(frame({0x21, 6, 7, 8, 9, 10, 11, 12}), IsoTp::kTimeout_us + 2), Event::kNone);
}

TEST(IsoTp, BothDirectionsAtOnce) {
  IsoTp a = tester(), b = node();
  ASSERT_EQ(a.send(counting(100), 0), Status::kOk);
  ASSERT_EQ(b.send(counting(90), 0), Status::kOk);
  bool a_done = false, b_done = false;
  for (int k = 0; k < 200 && !(a_done && b_done); ++k) {
    if (const auto f = a.transmit(0)) b_done |= b.receive(*f, 0) == Event::kReceived;
    if (const auto f = b.transmit(0)) a_done |= a.receive(*f, 0) == Event::kReceived;
  }
  ASSERT_TRUE(a_done && b_done);
  EXPECT_EQ(received(a), counting(90));
  EXPECT_EQ(received(b), counting(100));
}

}  // namespace
}  // namespace triskin::wire
