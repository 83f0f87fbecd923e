// SPDX-License-Identifier: GPL-3.0-or-later
// A place that states another version than CMakeLists.txt must be found and named.
#include <gtest/gtest.h>

#include "tools/scratch_tree.hpp"

namespace triskin::tests {
namespace {

class OneVersion : public ScratchTree {
 protected:
  void SetUp() override {
    ScratchTree::SetUp();
    write_all();
  }
  void write_all() {
    write("CMakeLists.txt", "cmake_minimum_required(VERSION 3.25)\nproject(triskin VERSION 1.2.3 LANGUAGES CXX)\n");
    write("CHANGELOG.md", "# Changelog\n\n## 1.2.3 (unreleased)\n\n## 1.2.2\n");
    write("host/output/bridge/ros/triskin_msgs/package.xml", "<?xml version=\"1.0\"?>\n<version>1.2.3</version>\n");
    write("docs/icub.md", "Give it protocol 2.0 and firmware 1.2.3 (that of the release).\n");
    write("tests/app/library/project/CMakeLists.txt", "find_package(triskin 1.2 REQUIRED)\n");
  }
};

TEST_F(OneVersion, is_accepted_where_all_say_it) {
  const Ran ran = tool("check_version", "--program 'echo'");
  EXPECT_EQ(ran.exit_status, 1) << "echo says --version";
  EXPECT_EQ(tool("check_version", "").exit_status, 0);
}

TEST_F(OneVersion, is_missed_in_each_place) {
  const auto refused = [&](const std::string& path, const std::string& text, const std::string& said) {
    write_all();
    write(path, text);
    const Ran ran = tool("check_version", "");
    EXPECT_EQ(ran.exit_status, 1) << path;
    EXPECT_NE(ran.output.find(path + ": says " + said + ", CMakeLists.txt has 1.2.3"), std::string::npos) << ran.output;
  };
  refused("CHANGELOG.md", "# Changelog\n\n## 1.2.4 (unreleased)\n\n## 1.2.3\n", "1.2.4");
  refused("host/output/bridge/ros/triskin_msgs/package.xml", "<version>0.1.0</version>\n", "0.1.0");
  refused("docs/icub.md", "firmware 1.2.3\n", "no version");
  refused("tests/app/library/project/CMakeLists.txt", "find_package(triskin 1.1 REQUIRED)\n", "1.1");
}

}  // namespace
}  // namespace triskin::tests
