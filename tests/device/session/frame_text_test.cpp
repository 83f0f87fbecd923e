// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the text of dump for the frames that docs/protocol.md shows.
#include "triskin/session/frame_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "triskin/session/firmware_version.hpp"
#include "vectors/frame_text.hpp"

namespace triskin::session {
namespace {

using test::frame_of;

std::string text(const std::string& frame) {
  return FrameReader().text(frame_of(frame));
}

TEST(FrameText, bytes_stand_as_candump_prints_them) {
  EXPECT_EQ(bytes_text(frame_of("E 18E0FFF1")), "18E0FFF1   [0]  ");
  EXPECT_EQ(bytes_text(frame_of("S 412 40 01")), "     412   [2]  40 01");
  EXPECT_EQ(bytes_text(frame_of("F 18DA01F1 02 10 03 00 00 00 00 00 00 00 00 00")),
            "18DA01F1  [12]  02 10 03 00 00 00 00 00 00 00 00 00");
}

TEST(FrameText, the_search_for_controllers) {
  EXPECT_EQ(text("E 18E0FFF1"), "who is there?");
  EXPECT_EQ(text("E 1E5FC655 00 01 02 03 04 05 06 07"), "claim: unique id 01020304050607…");
  EXPECT_EQ(text("E 1E5FC655 01 08 09 0A 0B 0C 01 00"), "claim: unique id …08090A0B0C, node address 1, no table");
  EXPECT_EQ(text("E 18E1FFF1 01 08 09 0A 0B 0C 05 E9"), "assignment: unique id …08090A0B0C gets node address 5");
  EXPECT_EQ(text("E 18E2FFF1 78 56 34 12 64 02 85 02"), "lease of reader 12345678: 1000 ms, every 2. sample");
  EXPECT_EQ(text("E 18E2FFF1 78 56 34 12 00 01 00 00"), "lease of reader 12345678 ends");
}

TEST(FrameText, requests_and_answers) {
  EXPECT_EQ(text("E 18DA07F1 02 10 03 00 00 00 00 00"), "request to 7: session");
  EXPECT_EQ(text("E 18DA07F1 03 22 FD 10 00 00 00 00"), "request to 7: read FD10");
  EXPECT_EQ(text("E 18DAF107 04 71 01 02 04 00 00 00"), "answer of 7: routine 0204: done");
  EXPECT_EQ(text("E 18DAF107 03 7F 22 31 00 00 00 00"), "answer of 7: read refused: out of range");
  EXPECT_EQ(text("E 18DB33F1 02 3E 80 00 00 00 00 00"), "request to all: tester present");
}

// The message has 20 bytes: six in the first frame, seven in each of the others.
TEST(FrameText, a_long_message_is_named_when_it_is_whole) {
  FrameReader reader;
  EXPECT_EQ(reader.text(frame_of("E 18DAF103 10 14 62 FD 00 01 02 03")),
            "answer of 3: first part of 20 bytes, read FD00: done");
  EXPECT_EQ(reader.text(frame_of("E 18DA03F1 30 00 00 00 00 00 00 00")), "request to 3: go on");
  EXPECT_EQ(reader.text(frame_of("E 18DAF103 21 01 02 03 04 05 06 07")), "answer of 3: part 1, 13 of 20 bytes");
  EXPECT_EQ(reader.text(frame_of("E 18DAF103 22 01 02 03 04 05 06 07")),
            "answer of 3: whole: read FD00: done, 20 bytes");
  EXPECT_EQ(reader.text(frame_of("E 18DAF103 23 01 02 03 04 05 06 07")),
            "answer of 3: part of a message whose beginning was not seen");
}

TEST(FrameText, frames_of_icub_boards_and_of_strangers) {
  EXPECT_EQ(text("S 435 40 01 02 03 04 05 06 07"), "iCub taxels of board 3, triangle 5");
  EXPECT_EQ(text("S 20E 4D"), "iCub command 4D from 0 to 14");
  EXPECT_EQ(text("S 123 00"), "not of Triskin");
  EXPECT_EQ(text("E 00000001 00"), "not of Triskin");
}

TEST(FrameText, frames_of_updates) {
  EXPECT_EQ(text("E 1BF40000 06 34 12 55 C6 5F 92 00"), "update: command 6");
  EXPECT_EQ(text("E 1BF90102 00 11 22 33 44 55 66 77"), "update: data for slot 1, unit 258");
  EXPECT_EQ(text("E 1BF80008 00 11 22 33 44 55 66 77"), "update: data for slot 0, unit 8");
  EXPECT_EQ(text("E 1BF9FFFF 00 11 22 33 44 55 66 77"), "update: data for slot 1, unit 65535");
}

// Major, minor and patch; the build number is left out.
TEST(FirmwareVersion, has_three_numbers) {
  EXPECT_EQ(firmware_version_text(0x01020304), "1.2.3");
  EXPECT_EQ(firmware_version_text(0xFF00FE00), "255.0.254");
}

TEST(FrameText, whatever_a_bus_carries_has_a_text) {
  FrameReader reader;
  std::uint32_t state = 1;
  for (int k = 0; k < 20'000; ++k) {
    wire::CanFrame f;
    state = state * 1664525 + 1013904223;
    f.extended = (state >> 8 & 1) != 0;
    const std::uint32_t ids[] = {0x18DA01F1, 0x18DAF101, 0x18DB33F1, 0x18E1FFF1,
                                 0x18E2FFF1, 0x18F00102, 0x1C000001, state >> 3};
    f.id = ids[state >> 12 & 7];
    f.size = static_cast<std::uint8_t>(state >> 16 & 0xF);
    for (std::size_t b = 0; b < f.size; ++b) f.data[b] = static_cast<std::uint8_t>((state >> (b % 24)) ^ b * 37);
    EXPECT_FALSE(reader.text(f).empty());
  }
}

}  // namespace
}  // namespace triskin::session
