// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/wire/taxel_frames.hpp"

#include <gtest/gtest.h>

#include "vectors/frame_text.hpp"

namespace triskin::wire {
namespace {

using test::frame_of;
using test::Vector;

IcubTaxels icub_of(const Vector& v) {
  IcubTaxels t;
  t.board = static_cast<std::uint8_t>(v.number("board"));
  t.module = static_cast<std::uint8_t>(v.number("module"));
  const auto values = test::numbers(v.one("values"), 10);
  for (std::size_t k = 0; k < t.value.size(); ++k) t.value[k] = static_cast<std::uint8_t>(values.at(k));
  for (const std::uint64_t bit : test::numbers(v.one("out_of_range"), 10))
    t.out_of_range = static_cast<std::uint16_t>(t.out_of_range | 1U << bit);
  t.no_acknowledge = v.number("no_acknowledge") != 0;
  t.not_connected = v.number("not_connected") != 0;
  return t;
}

TaxelFrame full_of(const Vector& v) {
  TaxelFrame t;
  t.node_address = static_cast<std::uint8_t>(v.number("node"));
  t.module = static_cast<std::uint8_t>(v.number("module"));
  t.sample = static_cast<std::uint32_t>(v.number("sample"));
  t.device_time_us = v.number("device_time_us");
  t.valid = static_cast<std::uint16_t>(v.number("valid"));
  t.state = static_cast<ModuleState>(v.number("state"));
  const auto values = test::numbers(v.one("values"), 10);
  for (std::size_t k = 0; k < t.value.size(); ++k) t.value[k] = static_cast<std::uint16_t>(values.at(k));
  if (!v.has("dropped")) return t;
  t.dropped = static_cast<std::uint32_t>(v.number("dropped"));
  t.unread = static_cast<std::uint16_t>(v.number("unread"));
  t.starts = static_cast<std::uint8_t>(v.number("starts"));
  if (v.has("guests")) t.adopted_modules = static_cast<std::uint8_t>(v.number("guests"));
  return t;
}

TEST(TaxelVectors, EncodeAndDecodeAsTheFileSays) {
  int icub = 0, full = 0;
  for (const Vector& v : test::read_vectors("taxel_frames.txt")) {
    SCOPED_TRACE(v.name);
    const auto frames = v.all("frame");
    if (v.one("kind") == "icub") {
      ASSERT_EQ(frames.size(), 2U);
      const auto encoded = encode_icub(icub_of(v));
      EXPECT_EQ(encoded[0], frame_of(frames[0]));
      EXPECT_EQ(encoded[1], frame_of(frames[1]));
      EXPECT_EQ(decode_icub(frame_of(frames[0]), frame_of(frames[1])), icub_of(v));
      ++icub;
    } else {
      EXPECT_EQ(encode_full(full_of(v)), frame_of(frames.at(0)));
      EXPECT_EQ(decode_full(frame_of(frames.at(0))), full_of(v));
      ++full;
    }
  }
  EXPECT_GE(icub, 4);
  EXPECT_GE(full, 2);
}

TEST(TaxelFrames, ForeignFramesAreRefused) {
  const auto good = encode_icub({.board = 1, .module = 2});
  EXPECT_FALSE(decode_icub(good[1], good[0]));  // The second frame comes before the first.
  EXPECT_FALSE(decode_icub(good[0], good[0]));
  auto other = good;
  other[1].id ^= 1;  // The frames belong to two modules.
  EXPECT_FALSE(decode_icub(other[0], other[1]));
  other = good;
  other[1].size = 7;
  EXPECT_EQ(decode_icub(other[0], other[1]).error(), Status::kBadLength);
  other = good;
  other[0].extended = other[1].extended = true;
  EXPECT_FALSE(decode_icub(other[0], other[1]));
}

TEST(TaxelFrames, DamagedFullFramesAreRefused) {
  const CanFrame good = encode_full({.node_address = 4, .module = 15});
  ASSERT_TRUE(decode_full(good));
  CanFrame f = good;
  f.size = 32;
  EXPECT_EQ(decode_full(f).error(), Status::kBadLength);
  f = good;
  f.data[15] = 14;  // The module differs from the one in the identifier.
  EXPECT_FALSE(decode_full(f));
  f = good;
  f.data[14] = 9;  // This state does not exist.
  EXPECT_EQ(decode_full(f).error(), Status::kOutOfRange);
  f = good;
  f.data[13] = 0x10;  // There is no thirteenth taxel.
  EXPECT_EQ(decode_full(f).error(), Status::kOutOfRange);
  f = good;
  f.id ^= 0x100000;
  EXPECT_FALSE(decode_full(f));
  f = good;
  f.fd = false;
  EXPECT_FALSE(decode_full(f));
  EXPECT_FALSE(decode_full(encode_full({.node_address = 4, .module = 16})));
}

}  // namespace
}  // namespace triskin::wire
