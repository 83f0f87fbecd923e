// SPDX-License-Identifier: GPL-3.0-or-later
// Every real cover becomes a design that the independent checker accepts; broken files end in a clear error.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "triskin/check/design_rules.hpp"
#include "triskin/host/error.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin {
namespace {

namespace fs = std::filesystem;

fs::path data_folder() {
  const char* named = std::getenv("TRISKIN_DATA");
  return named != nullptr ? named : TRISKIN_DATA;
}

class Parts : public testing::TestWithParam<const char*> {};

TEST_P(Parts, designs_and_passes_every_rule) {
  const fs::path mesh = data_folder() / "parts" / (std::string(GetParam()) + ".obj");
  ASSERT_TRUE(fs::exists(mesh)) << mesh
                                << ": the real covers are missing; set TRISKIN_DATA to the folder that holds parts/";
  pipeline::DesignOptions options;
  options.time_limit_s = 6.0;
  const design::Design design = pipeline::make_design(mesh, options);
  EXPECT_GE(design.layout.modules.size(), 5U);
  const fs::path file = fs::temp_directory_path() /
                        (std::string("parts_test.") + GetParam() + "." + std::to_string(::getpid()) + ".json");
  design::write_design(file, design);
  EXPECT_EQ(design::read_design(file).design_id, design.design_id);
  for (const auto& v : check::check_design(file).violations) ADD_FAILURE() << v.rule << " " << v.where << " " << v.text;
  fs::remove(file);
}

INSTANTIATE_TEST_SUITE_P(Covers, Parts,
                         testing::Values("HEAD_v1", "HIP_v1", "LH_hipwing_v1", "LT_root_v2", "LUA_upperarm_half_v1",
                                         "RFA_forearm_v1", "ROOT_v25", "RUF_forearm_v2", "SHANK_front_v25",
                                         "UA_upperarm_v1", "UL_upperleg_v1", "UT_torso_v1"),
                         [](const auto& part) { return std::string(part.param); });

TEST(HardMeshes, end_in_a_result_or_a_clear_error) {
  for (const char* name : {"icub25_l_hip_2", "icub25_root_link", "upmc_icub_chest"}) {
    const fs::path mesh = data_folder() / "hard" / (std::string(name) + ".stl");
    ASSERT_TRUE(fs::exists(mesh)) << mesh;
    try {
      pipeline::DesignOptions options;
      options.time_limit_s = 5.0;
      EXPECT_GT(pipeline::make_design(mesh, options).layout.modules.size(), 0U);
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(name), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("mm"), std::string::npos) << "the place is missing: " << e.what();
    }
  }
}

std::string error_of(const std::string& file_name, const std::string& content,
                     std::optional<geometry::LengthUnit> unit = {}) {
  const fs::path path = fs::temp_directory_path() / (std::to_string(::getpid()) + "." + file_name);
  std::ofstream(path, std::ios::binary) << content;
  std::string message;
  try {
    pipeline::DesignOptions options;
    options.unit = unit;
    options.time_limit_s = 1.0;
    (void)pipeline::make_design(path, options);
  } catch (const InputError& e) {
    message = e.what();
    EXPECT_NE(message.find(path.filename().string()), std::string::npos) << message;
  }
  fs::remove(path);
  return message;
}

TEST(BadMeshes, are_named_with_the_reason) {
  const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  EXPECT_TRUE(has(error_of("empty.obj", ""), "empty"));
  EXPECT_TRUE(has(error_of("noise.stl", std::string(3000, '\x7f')), "not a mesh"));
  EXPECT_TRUE(has(error_of("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), "no triangle"));
  EXPECT_TRUE(has(error_of("line.obj", "v 0 0 0\nv 100 0 0\nv 200 0 0\nf 1 2 3\n"), "no triangle"));
  EXPECT_TRUE(has(error_of("metres.obj", "v 0 0 0\nv 0.3 0 0\nv 0 0.3 0\nf 1 2 3\n"), "--unit m"));
  EXPECT_EQ(error_of("metres.obj", "v 0 0 0\nv 0.3 0 0\nv 0 0.3 0\nf 1 2 3\n", geometry::LengthUnit::kMetre), "");
  EXPECT_TRUE(has(error_of("huge.obj", "v 0 0 0\nv 3e5 0 0\nv 0 3e5 0\nf 1 2 3\n"), "larger than a body part"));
  EXPECT_NE(error_of("nan.obj", "v nan 0 0\nv 100 0 0\nv 0 100 0\nf 1 2 3\n"), "");
  EXPECT_TRUE(
      has(error_of("fan.obj", "v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 -100 0\nv 0 0 100\nf 1 2 3\nf 2 1 4\nf 1 2 5\n"),
          "not a manifold"));
}

}  // namespace
}  // namespace triskin
