// SPDX-License-Identifier: GPL-3.0-or-later
// The frames of tests/vectors/frames.txt, which docs/protocol.md shows.
#include <gtest/gtest.h>

#include "triskin/wire/node_claim.hpp"
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
