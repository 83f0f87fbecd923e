// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the frames of tests/vectors/frames.txt, which docs/protocol.md shows.
#include <gtest/gtest.h>

#include "triskin/wire/adoption.hpp"
#include "triskin/wire/bus_load.hpp"
#include "triskin/wire/log.hpp"
#include "triskin/wire/node_claim.hpp"
#include "triskin/wire/stream_lease.hpp"
#include "triskin/wire/usb_packet.hpp"
#include "vectors/frame_text.hpp"

namespace triskin::wire {
namespace {

using test::frame_of;
using test::hex_bytes;
using test::Vector;

UniqueId unique_id_of(const Vector& v) {
  UniqueId id{};
  const auto bytes = hex_bytes(v.one("unique_id"));
  EXPECT_EQ(bytes.size(), id.size());
  std::ranges::copy(bytes, id.begin());
  return id;
}

Vector vector_named(const std::string& name) {
  for (const Vector& v : test::read_vectors("frames.txt")) {
    if (v.name == name) return v;
  }
  throw std::runtime_error("no vector " + name);
}

void expect_frames(const Vector& v, std::span<const CanFrame> frames) {
  const auto lines = v.all("frame");
  ASSERT_EQ(lines.size(), frames.size());
  for (std::size_t k = 0; k < frames.size(); ++k) EXPECT_EQ(frames[k], frame_of(lines[k])) << v.name << ", frame " << k;
}

TEST(FrameVectors, the_search_for_controllers) {
  expect_frames(vector_named("who is there"), std::array{who_is_there()});
  const Vector claim = vector_named("a claim"), assignment = vector_named("an assignment");
  const auto node = [](const Vector& v) { return static_cast<std::uint8_t>(v.number("node")); };
  expect_frames(claim, encode_claim({unique_id_of(claim), node(claim), claim.number("has_table") != 0}));
  expect_frames(assignment, encode_assignment(unique_id_of(assignment), node(assignment)));
}

TEST(FrameVectors, leases) {
  for (const char* name : {"a lease", "the end of a lease"}) {
    const Vector v = vector_named(name);
    const StreamLease lease{
        static_cast<std::uint32_t>(v.number("reader")), static_cast<std::uint8_t>(v.number("lasts_10ms")),
        static_cast<std::uint8_t>(v.number("every")), static_cast<std::uint16_t>(v.number("pace_100us"))};
    expect_frames(v, std::array{encode_lease(lease)});
    EXPECT_EQ(decode_lease(frame_of(v.one("frame"))), lease);
  }
}

TEST(FrameVectors, what_a_controller_reaches) {
  for (const char* name : {"out of reach", "modules taken in"}) {
    const Vector v = vector_named(name);
    const auto byte = [&](const char* key) { return static_cast<std::uint8_t>(v.number(key)); };
    const Reach reach{byte("node"), static_cast<std::uint16_t>(v.number("rows")), byte("guests"), byte("list")};
    expect_frames(v, std::array{encode_reach(reach)});
    EXPECT_EQ(decode_reach(frame_of(v.one("frame"))), reach);
  }
}

LogLine log_line_of(const Vector& v) {
  LogLine line;
  line.level = static_cast<LogLevel>(v.number("level"));
  line.number = static_cast<std::uint8_t>(v.number("number"));
  line.time_ms = static_cast<std::uint32_t>(v.number("time_ms"));
  for (const char c : v.one("text")) line.text[line.size++] = c;
  return line;
}

TEST(FrameVectors, lines_of_the_log) {
  for (const auto& [name, frame_bytes] :
       {std::pair{"a line of the log", 8}, {"a line of the log in an FD frame", 64}}) {
    const Vector v = vector_named(name);
    const LogLine line = log_line_of(v);
    const auto bytes = static_cast<std::uint8_t>(frame_bytes);
    LogEncoder encoder;
    LogDecoder decoder;
    std::vector<CanFrame> frames;
    std::optional<LogLine> decoded;
    for (bool done = false; !done;) {
      frames.push_back(encoder.frame(line, static_cast<std::uint8_t>(v.number("node")), bytes));
      EXPECT_FALSE(decoded) << "before its last frame";
      decoded = decoder.add(frames.back());
      done = encoder.sent(line, bytes);
    }
    expect_frames(v, frames);
    EXPECT_EQ(decoded, line);
  }
}

// The second of four frames is lost, so this line is dropped, and the next one is whole.
TEST(Log, a_line_with_a_lost_frame_is_dropped) {
  const LogLine line = log_line_of(vector_named("a line of the log"));
  LogEncoder encoder;
  LogDecoder decoder;
  std::vector<LogLine> lines;
  for (int k = 0; k < 8; ++k) {
    const CanFrame f = encoder.frame(line, 5, 8);
    if (k != 1) {
      if (const auto whole = decoder.add(f)) lines.push_back(*whole);
    }
    EXPECT_EQ(encoder.sent(line, 8), k % 4 == 3);
  }
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0], line);
}

TEST(Log, frames_of_others_and_damaged_ones_are_ignored) {
  const LogLine line = log_line_of(vector_named("a line of the log in an FD frame"));
  const CanFrame good = LogEncoder{}.frame(line, 5, 64);
  const auto reads = [](const CanFrame& f) { return LogDecoder{}.add(f).has_value(); };
  ASSERT_TRUE(reads(good));
  CanFrame f = good;
  f.id = kReachBase | 5;
  EXPECT_FALSE(reads(f));
  f = good;
  f.extended = false;
  EXPECT_FALSE(reads(f));
  f = good;
  f.data[1] = 5;  // No such level exists.
  EXPECT_FALSE(reads(f));
  f = good;
  f.size = 6;  // The frame has not even a head.
  EXPECT_FALSE(reads(f));
  f = good;
  f.size = 0;
  EXPECT_FALSE(reads(f));
}

// An empty line is one frame, and the longest line arrives whole.
TEST(Log, any_length_of_text_arrives) {
  for (std::size_t size = 0; size <= kMaxLogText; ++size) {
    for (const std::uint8_t bytes : {std::uint8_t{8}, std::uint8_t{48}, std::uint8_t{64}}) {
      LogLine line;
      for (std::size_t k = 0; k < size; ++k) line.text[line.size++] = static_cast<char>('a' + k % 26);
      LogEncoder encoder;
      LogDecoder decoder;
      std::optional<LogLine> got;
      int frames = 0;
      for (bool done = false; !done; ++frames) {
        const CanFrame f = encoder.frame(line, 1, bytes);
        ASSERT_LE(f.size, std::min<int>(bytes, kUsbFrameBytes));
        got = decoder.add(f);
        done = encoder.sent(line, bytes);
      }
      ASSERT_EQ(got, line) << size << " bytes in frames of " << int{bytes};
      const std::size_t room = std::min<std::size_t>(bytes, kUsbFrameBytes);
      const std::size_t rest = size > room - 7 ? size - (room - 7) : 0;
      EXPECT_EQ(frames, 1 + static_cast<int>((rest + room - 2) / (room - 1)));
    }
  }
}

TEST(Reach, damaged_frames_are_refused) {
  const CanFrame good = encode_reach({5, 22, 0, 0});
  ASSERT_TRUE(decode_reach(good));
  CanFrame f = good;
  f.size = 5;
  EXPECT_EQ(decode_reach(f).error(), Status::kBadLength);
  f = good;
  f.data[2] = 16;  // A controller reads at most sixteen modules, one of them its own.
  EXPECT_EQ(decode_reach(f).error(), Status::kOutOfRange);
  f = good;
  f.id = kReachBase;  // This is no node address.
  EXPECT_EQ(decode_reach(f).error(), Status::kOutOfRange);
  f = good;
  f.id = kReachBase + 0x105;
  EXPECT_EQ(decode_reach(f).error(), Status::kOutOfRange);
  f = good;
  f.extended = false;
  EXPECT_EQ(decode_reach(f).error(), Status::kOutOfRange);
}

TEST(Leases, damaged_ones_are_refused) {
  const CanFrame good = encode_lease({1, 100, 1, 0});
  ASSERT_TRUE(decode_lease(good));
  CanFrame f = good;
  f.size = 7;
  EXPECT_EQ(decode_lease(f).error(), Status::kBadLength);
  f = good;
  f.data[0] = 0;  // There is no reader.
  EXPECT_EQ(decode_lease(f).error(), Status::kOutOfRange);
  f = good;
  f.data[5] = 0;  // There is no n-th sample.
  EXPECT_EQ(decode_lease(f).error(), Status::kOutOfRange);
  f = good;
  f.extended = false;
  EXPECT_EQ(decode_lease(f).error(), Status::kOutOfRange);
}

// By ISO 11898-1 there are 36 + 9 + 13 bits at 1 Mbit/s, then 6 + 384 + 97 + 4 + 21 + 7 at 2 Mbit/s. 193 modules at
// 36.9 ms are 1.66 of such a bus; on a classic one the iCub stream of 16 modules at 50 ms is 0.09.
TEST(BusLoad, of_the_stream) {
  const BitRates fd{1'000'000, 2'000'000}, classic{1'000'000, 0};
  EXPECT_EQ(full_sample_ns(fd), 58'000U + 259'500U);
  EXPECT_NEAR(stream_load(193, full_sample_ns(fd), 36'900), 1.6606, 1e-4);
  EXPECT_EQ(icub_sample_ns(classic), 2 * 135'000U);
  EXPECT_NEAR(stream_load(16, icub_sample_ns(classic), 50'000), 0.0864, 1e-4);
  EXPECT_EQ(full_sample_ns({}), 0U);
}

TEST(FrameVectors, frames_in_usb_packets) {
  for (const char* name : {"usb packet", "usb packet of an FD frame"}) {
    const Vector v = vector_named(name);
    const CanFrame frame = frame_of(v.one("frame"));
    const auto packet = to_usb(frame);
    ASSERT_TRUE(packet);
    const auto expected = hex_bytes(v.one("packet"));
    EXPECT_TRUE(std::ranges::equal(packet->used(), expected)) << name;
    EXPECT_EQ(from_usb(expected), frame) << name;
  }
}

}  // namespace
}  // namespace triskin::wire
