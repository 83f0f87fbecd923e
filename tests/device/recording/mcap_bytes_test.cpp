// SPDX-License-Identifier: GPL-3.0-or-later
// Compares records and CDR with bytes that were worked out by hand from the public specifications.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "triskin/recording/cdr.hpp"
#include "triskin/recording/mcap_file.hpp"

namespace triskin::recording {
namespace {

using testing::ElementsAreArray;
using List = std::vector<int>;

List list(Bytes bytes) {
  return {bytes.begin(), bytes.end()};
}

// The message has kind 5 and 24 bytes: channel 1, sequence 7, log time 1000 = 0x3E8, publish time 1000, data AA BB.
const List kMessage{5, 24, 0, 0, 0, 0, 0,    0, 0, 1, 0, 7, 0, 0, 0,    0xE8, 3,
                    0, 0,  0, 0, 0, 0, 0xE8, 3, 0, 0, 0, 0, 0, 0, 0xAA, 0xBB};

mcap::Buffer message() {
  const std::vector<std::uint8_t> data{0xAA, 0xBB};
  mcap::Buffer records;
  records.record(mcap::Kind::kMessage, encode(mcap::Message{1, 7, 1000, 1000, data}));
  return records;
}

TEST(McapBytes, a_message) {
  EXPECT_THAT(list(message().view()), ElementsAreArray(kMessage));
}

TEST(McapBytes, a_schema_and_a_channel) {
  EXPECT_THAT(
      list(encode(mcap::Schema{1, "T", "ros2msg", "x"}).view()),
      ElementsAreArray(List{1, 0, 1, 0, 0, 0, 'T', 7, 0, 0, 0, 'r', 'o', 's', '2', 'm', 's', 'g', 1, 0, 0, 0, 'x'}));
  // The map is 4 + 1 + 4 + 2 = 11 bytes long.
  EXPECT_THAT(list(encode(mcap::Channel{2, 1, "/t", "cdr", {{"k", "ab"}}}).view()),
              ElementsAreArray(List{2,   0,  1, 0, 2, 0, 0, 0, '/', 't', 3, 0, 0, 0, 'c', 'd',
                                    'r', 11, 0, 0, 0, 1, 0, 0, 0,   'k', 2, 0, 0, 0, 'a', 'b'}));
}

TEST(McapBytes, a_chunk_with_its_crc) {
  // The kind is 6; contents are 8 + 8 + 8 + 4 + 4 + 8 = 40 bytes of head and 33 of records. zlib gives the CRC
  // 0x957D7C16 of the records.
  List expected{6,  73, 0, 0, 0, 0, 0, 0, 0,    0xE8, 3,    0,    0, 0, 0, 0, 0,  0xE8, 3, 0, 0, 0, 0, 0, 0,
                33, 0,  0, 0, 0, 0, 0, 0, 0x16, 0x7C, 0x7D, 0x95, 0, 0, 0, 0, 33, 0,    0, 0, 0, 0, 0, 0};
  expected.insert(expected.end(), kMessage.begin(), kMessage.end());
  EXPECT_THAT(list(mcap::encode_chunk(1000, 1000, message()).view()), ElementsAreArray(expected));
}

TEST(McapBytes, an_index_names_time_and_offset) {
  EXPECT_THAT(list(mcap::index_of(message().view()).view()),
              ElementsAreArray(List{7, 22, 0, 0, 0, 0, 0, 0, 0, 1, 0, 16, 0, 0, 0, 0xE8,
                                    3, 0,  0, 0, 0, 0, 0, 0, 0, 0, 0, 0,  0, 0, 0}));
}

TEST(McapBytes, an_attachment_with_its_crc) {
  // zlib gives the CRC of the 36 bytes before it.
  EXPECT_THAT(list(encode(mcap::Attachment{5, 0, "a", "b", "hi"}).view()),
              ElementsAreArray(List{5,   0, 0, 0, 0, 0,   0, 0, 0, 0, 0, 0, 0, 0, 0,   0,   1,    0,    0,    0,
                                    'a', 1, 0, 0, 0, 'b', 2, 0, 0, 0, 0, 0, 0, 0, 'h', 'i', 0xF8, 0x05, 0x24, 0x19}));
}

TEST(McapBytes, a_damaged_attachment_is_refused) {
  mcap::Buffer good = encode(mcap::Attachment{5, 0, "a", "b", "hi"});
  mcap::Attachment a;
  ASSERT_TRUE(decode(good.view(), a));
  EXPECT_EQ(a.data, "hi");
  std::vector<std::uint8_t> bad(good.view().begin(), good.view().end());
  bad[34] ^= 1;
  EXPECT_FALSE(decode(bad, a));
  for (std::size_t n = 0; n < good.size(); ++n) EXPECT_FALSE(decode(good.view().first(n), a)) << n;
}

TEST(CdrBytes, fields_are_aligned_to_their_size_behind_the_head) {
  CdrWriter w;
  w.u8(1);
  w.u16(2);
  w.u32(3);
  w.text("ab");
  w.u64(4);
  w.f32(1.0F);
  // The rows have the head of plain little-endian CDR; u8, one byte of padding, u16, u32; the text with its length,
  // which includes the 0, padded to 16 bytes; and the last two numbers.
  EXPECT_THAT(list(w.message()), ElementsAreArray(List{0, 1, 0, 0,                  //
                                                       1, 0, 2, 0, 3,   0,   0, 0,  //
                                                       3, 0, 0, 0, 'a', 'b', 0, 0,  //
                                                       4, 0, 0, 0, 0,   0,   0, 0, 0, 0, 0x80, 0x3F}));
  CdrReader r(w.message());
  EXPECT_EQ(r.u8(), 1);
  EXPECT_EQ(r.u16(), 2);
  EXPECT_EQ(r.u32(), 3U);
  EXPECT_EQ(r.text(), "ab");
  EXPECT_EQ(r.u64(), 4U);
  EXPECT_EQ(r.f32(), 1.0F);
  EXPECT_TRUE(r.ok());
  EXPECT_EQ(r.u8(), 0);
  EXPECT_FALSE(r.ok());
}

TEST(CdrBytes, a_length_beyond_the_message_is_no_allocation) {
  const std::vector<std::uint8_t> message{0, 1, 0, 0, 0xFF, 0xFF, 0xFF, 0x7F};
  CdrReader r(message);
  EXPECT_EQ(r.count(1), 0U);
  EXPECT_FALSE(r.ok());
}

}  // namespace
}  // namespace triskin::recording
