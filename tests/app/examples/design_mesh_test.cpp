// SPDX-License-Identifier: GPL-3.0-or-later
// The program docs/examples/design_mesh.cpp must do what it says.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "triskin/base/files.hpp"
#include "triskin/design/design.hpp"

namespace triskin {
namespace {

namespace fs = std::filesystem;

class DesignMeshExample : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  // Returns the exit status, and the text on standard output and error.
  std::pair<int, std::string> run(const std::string& mesh) {
    write_file_atomically(folder_ / "plate.obj", mesh);
    const std::string out = folder_ / "out";
    const int status = std::system(
        fmt::format("'{}' '{}' '{}' > '{}' 2>&1", TRISKIN_EXAMPLE, (folder_ / "plate.obj").string(), design_file(), out)
            .c_str());
    return {WEXITSTATUS(status), read_file(out)};
  }
  [[nodiscard]] std::string design_file() const { return folder_ / "plate.json"; }

 private:
  fs::path folder_ = fs::temp_directory_path() / ("design_mesh_example." + std::to_string(::getpid()));
};

TEST_F(DesignMeshExample, lists_the_modules_of_a_plate) {
  const auto [status, text] = run("v 0 0 0\nv 100 0 0\nv 100 100 0\nv 0 100 0\nf 1 2 3\nf 1 3 4\n");
  EXPECT_EQ(status, 0) << text;
  const design::Design design = design::read_design(design_file());
  const std::size_t modules = design.layout.modules.size();
  // A module has 390 mm², so 25 of them would fill the 10,000 mm² without a gap.
  EXPECT_GE(modules, 8U);
  EXPECT_LE(modules, 25U);
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(text, '\n')), modules + 1) << text;
  EXPECT_NE(text.find(fmt::format("{} modules, {} controllers\n", modules, design.patches.size())), std::string::npos);
}

TEST_F(DesignMeshExample, says_why_a_file_cannot_be_used) {
  const auto [status, text] = run("nothing\n");
  EXPECT_EQ(status, 1);
  EXPECT_NE(text.find("plate.obj"), std::string::npos) << text;
}

}  // namespace
}  // namespace triskin
