// SPDX-License-Identifier: GPL-3.0-or-later
// Equal scenes must give equal frames, whatever compiler built the program and however many threads run.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <thread>

#include "frames.hpp"

namespace triskin::test {
namespace {

// These are the hashes of 12 s of frames. gcc 12 and clang 19 with the GNU C library 2.36 both give them, because
// nothing is contracted (-ffp-contract=off) and no distribution of the standard library is used. The noise takes log
// and cos from the C library: another library may round a sample to the neighbouring count.
const std::map<std::string, std::uint64_t> kHashes{
    {"assembly_mistakes", 0xa9613e08b5a4ff0f}, {"brown_out", 0x837857f24d09ee01},
    {"drumming", 0x2596489fd29e6940},          {"grasp_forearm", 0xbc831ad04fec6a23},
    {"push_torso", 0x25cb7b05c3a7648d},        {"sliding_finger", 0xe961c77ca1299b12},
    {"warming", 0xe4b885b7d6d2ef3f},
};

class Frames : public testing::TestWithParam<std::string> {};

TEST_P(Frames, are_those_of_every_compiler) {
  const hardware::Scene scene = hardware::read_scene(scene_folder() / (GetParam() + ".json"));
  const std::vector<SentFrame> frames = frames_of(scene, 12.0);
  EXPECT_GT(frames.size(), 5000U);
  ASSERT_TRUE(kHashes.contains(GetParam())) << "add the new scene to the list";
  EXPECT_EQ(hash_of(frames), kHashes.at(GetParam())) << fmt::format(
      "{:#018x}: if firmware, bus or scene were changed on purpose, put this number into the list; else "
      "look for an arithmetic that depends on compiler or C library",
      hash_of(frames));
}

TEST_P(Frames, are_equal_in_one_thread_and_in_two) {
  const hardware::Scene scene = hardware::read_scene(scene_folder() / (GetParam() + ".json"));
  const std::uint64_t alone = hash_of(frames_of(scene, 3.0));
  std::uint64_t first = 0, second = 0;
  std::thread one([&] { first = hash_of(frames_of(scene, 3.0)); });
  std::thread two([&] { second = hash_of(frames_of(scene, 3.0)); });
  one.join();
  two.join();
  EXPECT_EQ(first, alone);
  EXPECT_EQ(second, alone);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Frames, testing::ValuesIn(ready_scenes()));

}  // namespace
}  // namespace triskin::test
