// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "support/places.hpp"
#include "triskin/design/design.hpp"

namespace triskin::test {

/// Runs commands on the simulated switched modules of one design, as processes, in their own folder.
class SwitchedCase : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("switched_case." + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    design_ = make_design();
    design::write_design(folder_ / "patch.json", design_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  virtual design::Design make_design() = 0;

  void scene(const nlohmann::json& faults) const {
    std::ofstream(folder_ / "scene.json") << nlohmann::json{
        {"format", "triskin-scene"},
        {"version", 1},
        {"design", "patch.json"},
        {"hardware", "switched"},
        {"faults", faults}}.dump();
  }
  /// The simulated boards keep their flash in this folder between commands.
  nlohmann::json run(const std::string& command, int expected_status, const std::string& link = " --link sim") const {
    const std::string line = "cd '" + folder_.string() + "' && XDG_STATE_HOME='" + folder_.string() + "' " +
                             program_file() + " " + command + link + " --json 2>messages";
    std::FILE* p = ::popen(line.c_str(), "r");
    std::string text;
    for (int c = std::fgetc(p); c != EOF; c = std::fgetc(p)) text += static_cast<char>(c);
    EXPECT_EQ(WEXITSTATUS(::pclose(p)), expected_status) << command << '\n' << text;
    return nlohmann::json::parse(text, nullptr, false);
  }

  std::filesystem::path folder_;
  design::Design design_;
};

}  // namespace triskin::test
