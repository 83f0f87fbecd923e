// SPDX-License-Identifier: GPL-3.0-or-later
// The commands of docs/robot.md must do what the page says.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "support/places.hpp"

namespace triskin::test {
namespace {

TEST(RobotWalkThroughPage, its_commands_run) {
  if (!program_has_solvers()) GTEST_SKIP() << "built without the solvers";
  const auto program = std::filesystem::path(program_file());
  const std::string command = fmt::format("python3 '{0}/tools/check_readme' '{0}/docs/robot.md' '{1}'", source_folder(),
                                          program.parent_path().string());
  EXPECT_EQ(std::system(command.c_str()), 0);
}

}  // namespace
}  // namespace triskin::test
