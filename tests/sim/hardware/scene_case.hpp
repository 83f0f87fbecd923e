// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/hardware/scene.hpp"

namespace triskin::hardware {

/// Puts scene files beside the design of a strip of six modules, d.json.
class SceneCase : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("scene_case." + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    design::write_design(folder_ / "d.json", test::strip(6));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  /// Returns the reader's message about a scene with this text.
  [[nodiscard]] std::string error_of(const std::string& text) const {
    write_file_atomically(folder_ / "s.json", text);
    try {
      (void)read_scene(folder_ / "s.json");
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  }
  std::filesystem::path folder_;
};

/// A fault in a scene, in line 3 of its file.
struct BadScene {
  const char* line;
  const char* remedy;  ///< The message must contain this statement of the fault or the remedy.
};

inline void PrintTo(const BadScene& bad, std::ostream* out) {
  *out << bad.line;
}

}  // namespace triskin::hardware
