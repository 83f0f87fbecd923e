// SPDX-License-Identifier: GPL-3.0-or-later
// The expectations of the scenes in docs/examples/scenes must hold, and the page must name all scenes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/places.hpp"
#include "triskin/base/files.hpp"
#include "triskin/scenario/scene_check.hpp"

namespace triskin::scenario {
namespace {

namespace fs = std::filesystem;

fs::path folder() {
  return fs::path(test::source_folder()) / "docs/examples/scenes";
}

std::vector<std::string> scene_files() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder())) {
    const auto document = nlohmann::json::parse(read_file(entry.path()));
    if (document["format"] == "triskin-scene") names.push_back(entry.path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

class ReadyScenes : public testing::TestWithParam<std::string> {};

TEST_P(ReadyScenes, hold_what_they_expect) {
  const SceneCheck check = check_scene(hardware::read_scene(folder() / (GetParam() + ".json")));
  EXPECT_GE(check.results.size(), 5U);
  for (const ExpectationResult& r : check.results)
    EXPECT_TRUE(r.held) << r.expectation.place << ": " << hardware::text_of(r.expectation) << ": " << r.seen;
}

INSTANTIATE_TEST_SUITE_P(All, ReadyScenes, testing::ValuesIn(scene_files()));

TEST(ReadyScenesPage, names_every_scene) {
  const std::string page = read_file(fs::path(test::source_folder()) / "docs/examples.md");
  EXPECT_GE(scene_files().size(), 5U);
  for (const std::string& name : scene_files()) EXPECT_THAT(page, testing::HasSubstr(name + ".json"));
}

}  // namespace
}  // namespace triskin::scenario
