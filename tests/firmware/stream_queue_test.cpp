// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/stream/stream_queue.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace triskin::fw {
namespace {

std::vector<wire::CanFrame> frames_from(std::uint32_t first_id, std::size_t count) {
  std::vector<wire::CanFrame> frames(count);
  for (std::size_t k = 0; k < count; ++k) frames[k].id = first_id + static_cast<std::uint32_t>(k);
  return frames;
}

TEST(StreamQueue, GivesFramesInTheOrderTheyCame) {
  StreamQueue queue;
  EXPECT_TRUE(queue.empty());
  ASSERT_TRUE(queue.push(frames_from(10, 2)));
  ASSERT_TRUE(queue.push(frames_from(20, 1)));
  for (const std::uint32_t id : {10U, 11U, 20U}) {
    ASSERT_FALSE(queue.empty());
    EXPECT_EQ(queue.front().id, id);
    queue.pop();
  }
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.dropped(), 0U);
}

// With 46 of 47 places taken, two frames that belong together find no room, but one does.
TEST(StreamQueue, TakesAllFramesOrNone) {
  static_assert(StreamQueue::kCapacity == 47);
  StreamQueue queue;
  ASSERT_TRUE(queue.push(frames_from(0, 46)));
  EXPECT_FALSE(queue.push(frames_from(100, 2)));
  EXPECT_EQ(queue.size(), 46U);
  EXPECT_EQ(queue.dropped(), 2U);
  EXPECT_TRUE(queue.push(frames_from(200, 1)));
  EXPECT_FALSE(queue.push(frames_from(300, 1)));
  EXPECT_EQ(queue.dropped(), 3U);
  for (std::uint32_t id = 0; id < 46; ++id, queue.pop()) EXPECT_EQ(queue.front().id, id);
  EXPECT_EQ(queue.front().id, 200U);
}

// A hundred times, five go in and five out: the first place moves 500 places on, 30 behind the tenth turn of 47.
TEST(StreamQueue, GoesRoundItsRing) {
  StreamQueue queue;
  ASSERT_TRUE(queue.push(frames_from(0, 40)));
  std::uint32_t out = 0;
  for (std::uint32_t in = 40; in < 540; in += 5) {
    ASSERT_TRUE(queue.push(frames_from(in, 5)));
    for (int k = 0; k < 5; ++k, queue.pop()) ASSERT_EQ(queue.front().id, out++);
  }
  EXPECT_EQ(queue.size(), 40U);
  EXPECT_EQ(queue.dropped(), 0U);
}

TEST(StreamQueue, AClearedQueueHasDroppedNothing) {
  StreamQueue queue;
  ASSERT_TRUE(queue.push(frames_from(0, 47)));
  EXPECT_FALSE(queue.push(frames_from(50, 1)));
  queue.clear();
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.dropped(), 1U);
  ASSERT_TRUE(queue.push(frames_from(60, 47)));
  EXPECT_EQ(queue.front().id, 60U);
}

}  // namespace
}  // namespace triskin::fw
