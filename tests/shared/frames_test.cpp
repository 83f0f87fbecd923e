// SPDX-License-Identifier: GPL-3.0-or-later
// The frames of tests/vectors/frames.txt, which docs/protocol.md shows.
#include <gtest/gtest.h>

#include "triskin/wire/adoption.hpp"
#include "triskin/wire/bus_load.hpp"
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

TEST(Reach, damaged_frames_are_refused) {
  const CanFrame good = encode_reach({5, 22, 0, 0});
  ASSERT_TRUE(decode_reach(good));
  CanFrame f = good;
  f.size = 5;
  EXPECT_EQ(decode_reach(f).error(), Status::kBadLength);
  f = good;
  f.data[2] = 16;  // a controller reads sixteen modules at most, one of them its own
  EXPECT_EQ(decode_reach(f).error(), Status::kOutOfRange);
  f = good;
  f.id = kReachBase;  // no node address
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
  f.data[0] = 0;  // no reader
  EXPECT_EQ(decode_lease(f).error(), Status::kOutOfRange);
  f = good;
  f.data[5] = 0;  // no n-th sample
  EXPECT_EQ(decode_lease(f).error(), Status::kOutOfRange);
  f = good;
  f.extended = false;
  EXPECT_EQ(decode_lease(f).error(), Status::kOutOfRange);
}

// Worked from ISO 11898-1: 36 + 9 + 13 bits at 1 Mbit/s, then 6 + 384 + 97 + 4 + 21 + 7 at 2 Mbit/s. 193 modules
// at 36.9 ms are 1.66 of such a bus; of a classic one the iCub stream of 16 modules at 50 ms is 0.09.
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
