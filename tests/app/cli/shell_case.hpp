// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/places.hpp"
#include "triskin/base/files.hpp"

namespace triskin::test {

struct Outcome {
  int status = -1;
  std::string out, messages;
};

/// Runs the program as a shell does, in its own folder, which also keeps the simulated boards.
class ShellCase : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("shell_case." + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string line(const std::string& arguments) const {
    return fmt::format("cd '{}' && XDG_STATE_HOME=state exec {} {}", folder_.string(), program_file(), arguments);
  }
  /// Standard output is read unless the arguments redirect it with '>'.
  [[nodiscard]] Outcome run(const std::string& arguments) const {
    const bool redirected = arguments.find('>') != std::string::npos;
    const std::string command = line(arguments) + (redirected ? "" : " >out") + " 2>messages";
    Outcome outcome;
    outcome.status = WEXITSTATUS(std::system(command.c_str()));
    if (!redirected) outcome.out = read_file(folder_ / "out");
    outcome.messages = read_file(folder_ / "messages");
    return outcome;
  }

  std::filesystem::path folder_;
};

}  // namespace triskin::test
