// SPDX-License-Identifier: GPL-3.0-or-later
// `record --format rosbag2` writes a folder that a foreign YAML parser and @mcap/core find as rosbag2 writes it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "shell_case.hpp"
#include "support/places.hpp"
#include "support/strip_design.hpp"
#include "triskin/base/files.hpp"

namespace triskin::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

class Rosbag2 : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    design::write_design(folder_ / "strip.json", strip(4, 2));
    ASSERT_EQ(run("flash strip.json --link sim").status, 0);
  }
  // What the witness says of a bag.
  [[nodiscard]] std::string witness(const std::string& bag, int version) const {
    const fs::path modules = fs::path(source_folder()) / "build" / "npm", script = modules / "read_bag.mjs";
    fs::copy_file(fs::path(source_folder()) / "tests/app/cli/read_bag.mjs", script,
                  fs::copy_options::overwrite_existing);
    const std::string out = folder_ / "said";
    const std::string line = "node '" + script.string() + "' '" + (folder_ / bag).string() + "' " +
                             std::to_string(version) + " > '" + out + "' 2>&1";
    const int status = std::system(line.c_str());
    return (status == 0 ? "" : "failed: ") + read_file(out);
  }
  static bool is_without_witness() {
    return !fs::exists(fs::path(source_folder()) / "build/npm/node_modules/js-yaml") ||
           std::system("node --version > /dev/null 2>&1") != 0;
  }
};

TEST_F(Rosbag2, a_foreign_parser_finds_every_field_in_each_version) {
  if (is_without_witness()) GTEST_SKIP() << "js-yaml is not installed; run tools/setup test where npm is there";
  for (const int version : {5, 6, 7, 8, 9}) {
    const std::string bag = "bag" + std::to_string(version);
    const auto done = run("record strip.json --link sim --format rosbag2 -o " + bag + " --seconds 2" +
                          (version == 5 ? "" : " --rosbag2-version " + std::to_string(version)));
    ASSERT_EQ(done.status, 0) << done.messages;
    EXPECT_THAT(witness(bag, version), MatchesRegex("bag of 1 with [0-9]+ messages in 5 topics\n"));
  }
}

TEST_F(Rosbag2, a_bag_of_several_files_has_the_times_and_counts_of_each) {
  if (is_without_witness()) GTEST_SKIP() << "js-yaml is not installed; run tools/setup test where npm is there";
  const auto done = run("record strip.json --link sim --format rosbag2 -o parts/ --seconds 5 --split 2s");
  ASSERT_EQ(done.status, 0) << done.messages;
  EXPECT_TRUE(fs::exists(folder_ / "parts/parts_2.mcap"));
  EXPECT_THAT(witness("parts", 5), MatchesRegex("bag of 3 with [0-9]+ messages in 5 topics\n"));
  // A witness that overlooks a wrong number would be none.
  const std::string right = read_file(folder_ / "parts/metadata.yaml");
  std::string wrong = right;
  wrong.replace(wrong.find("message_count: ") + 15, 1, "9");
  write_file_atomically(folder_ / "parts/metadata.yaml", wrong);
  EXPECT_THAT(witness("parts", 5), HasSubstr("failed: messages"));
  EXPECT_THAT(witness("parts", 6), HasSubstr("failed: fields"));
}

TEST_F(Rosbag2, a_robot_gets_a_bag_for_each_cover_and_nothing_is_written_over) {
  ASSERT_EQ(run("robot new robot.json --name robot --bus can0=sim").status, 0);
  ASSERT_EQ(run("robot add robot.json strip.json --name arm --bus can0").status, 0);
  ASSERT_EQ(run("flash robot.json").status, 0);
  const auto done = run("record robot.json --format rosbag2 -o bags --seconds 1");
  ASSERT_EQ(done.status, 0) << done.messages;
  EXPECT_TRUE(fs::exists(folder_ / "bags/arm/arm_0.mcap"));
  EXPECT_THAT(read_file(folder_ / "bags/arm/metadata.yaml"), HasSubstr("name: /tf_static\n"));
  const auto again = run("record robot.json --format rosbag2 -o bags --seconds 1");
  EXPECT_EQ(again.status, 2);
  EXPECT_THAT(again.messages, HasSubstr("this is there already; give a new name"));
  const auto file = run("record strip.json --link sim --format rosbag2 -o bag.mcap");
  EXPECT_EQ(file.status, 2);
  EXPECT_THAT(file.messages, HasSubstr("a bag of ROS 2 is a folder"));
}

}  // namespace
}  // namespace triskin::test
