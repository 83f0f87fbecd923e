// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the serial numbers of simulated boards.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "support/strip_design.hpp"
#include "triskin/base/files.hpp"
#include "triskin/hardware/scene.hpp"

namespace triskin::hardware {
namespace {

std::vector<wire::UniqueId> ids_of(const Scene& scene) {
  std::vector<wire::UniqueId> ids;
  for (std::size_t p = 0; p < scene.design.patches.size(); ++p)
    ids.push_back(unique_id_of(scene, layout::PatchIndex{p}));
  return ids;
}

Scene numbered(std::optional<std::uint64_t> seed) {
  Scene scene;
  scene.design = test::strip(40, 4);  // There are ten patches.
  scene.board_seed = seed;
  return scene;
}

TEST(BoardNumbers, follow_the_seed_and_are_in_no_order) {
  EXPECT_TRUE(std::ranges::is_sorted(ids_of(numbered(std::nullopt))));
  EXPECT_EQ(ids_of(numbered(1)), ids_of(numbered(1)));
  std::set<wire::UniqueId> all;
  int sorted = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const auto ids = ids_of(numbered(seed));
    all.insert(ids.begin(), ids.end());
    sorted += std::ranges::is_sorted(ids) ? 1 : 0;
  }
  EXPECT_EQ(all.size(), 1000U);  // No two boards are equal.
  EXPECT_EQ(sorted, 0);          // The chance is one in 3.6 million.
  Scene other = numbered(1);
  ++other.design.design_id;
  EXPECT_NE(ids_of(other)[0], ids_of(numbered(1))[0]);
}

// The boards of a scene used to be on the bus in the order of their patches.
TEST(BoardNumbers, of_files_are_drawn_from_the_seed_of_the_scene) {
  const auto folder = std::filesystem::temp_directory_path() / ("board_numbers." + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  design::write_design(folder / "d.json", test::strip(40, 4));
  EXPECT_EQ(ids_of(read_scene(folder / "d.json")), ids_of(numbered(1)));
  write_file_atomically(folder / "s.json", R"({"format":"triskin-scene","version":1,"design":"d.json","seed":7})");
  EXPECT_EQ(ids_of(read_scene(folder / "s.json")), ids_of(numbered(7)));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace triskin::hardware
