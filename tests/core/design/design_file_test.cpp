// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/design/design.hpp"

namespace triskin::design {
namespace {

namespace fs = std::filesystem;
using design::kHeight_mm;
using design::Vec3;

// Makes two joined modules flat on the plane z = 0: the up triangle of cell (0, 0) and the down one beside it.
Design two_modules() {
  Design d;
  d.name = "two";
  d.source_file = "two.obj";
  d.surface.vertices = {{-1, -1, 0}, {50, -1, 0}, {50, 30, 0}, {-1, 30, 0}};
  d.surface.faces = {{0, 1, 2}, {0, 2, 3}};
  design::PlacedModule up;
  up.tile = {0, 0, true};
  up.corner_mm = {Vec3{0, 0, 0}, Vec3{30, 0, 0}, Vec3{15, kHeight_mm, 0}};
  up.neighbour = {-1, 1, -1};
  design::PlacedModule down;
  down.tile = {0, 0, false};
  down.corner_mm = {Vec3{30, 0, 0}, Vec3{45, kHeight_mm, 0}, Vec3{15, kHeight_mm, 0}};
  down.neighbour = {-1, -1, 0};
  d.layout.modules = {up, down};
  d.layout.islands = 1;
  d.layout.method = LayoutMethod::kSurface;
  d.layout.refused = {{"center_gap_mm", 3}};
  design::Patch patch;
  patch.entry = 0;
  patch.modules = {{0, -1, 0, 0, 0, 0}, {1, 0, 2, 0, 1, 1}};
  patch.max_depth = 1;
  patch.line_hops = 1;
  d.patches = {patch};
  d.design_id = design_id_of(d);
  return d;
}

class DesignFile : public testing::Test {
 protected:
  void SetUp() override {
    path_ = fs::temp_directory_path() / ("design_file_test." + std::to_string(::getpid()) + ".json");
    write_design(path_, two_modules());
    good_ = nlohmann::json::parse(read_file(path_));
  }
  void TearDown() override { fs::remove(path_); }

  std::string error_after(const std::function<void(nlohmann::json&)>& damage) {
    nlohmann::json j = good_;
    damage(j);
    return error_of(j.dump());
  }
  std::string error_of(const std::string& text) {
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << text;
    try {
      (void)read_design(path_);
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(path_.string()), std::string::npos) << e.what();
      return e.what();
    }
    return "";
  }

  fs::path path_;
  nlohmann::json good_;
};

TEST_F(DesignFile, round_trip_keeps_every_byte) {
  const std::string first = read_file(path_);
  write_design(path_, read_design(path_));
  EXPECT_EQ(read_file(path_), first);
}

TEST_F(DesignFile, names_the_key_that_is_wrong) {
  using J = nlohmann::json;
  const auto contains = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  EXPECT_TRUE(contains(error_after([](J& j) { j["version"] = 2; }), "version"));
  EXPECT_TRUE(contains(error_after([](J& j) { j["modules"][1].erase("corners"); }), "/modules/1: key \"corners\""));
  EXPECT_TRUE(contains(error_after([](J& j) { j["modules"][1]["neighbours"][2] = 2; }), "/modules/1/neighbours/2"));
  EXPECT_TRUE(contains(error_after([](J& j) { j["modules"][0]["line"] = 4; }), "/modules/0/line"));
  EXPECT_TRUE(contains(error_after([](J& j) { j["surface"]["faces"][0][0] = 9; }), "/surface/faces/0/0"));
  EXPECT_TRUE(contains(error_after([](J& j) { j["surface"]["vertices"][3][1] = nullptr; }), "/surface/vertices/3/1"));
  EXPECT_TRUE(contains(error_after([](J& j) { j["design_id"] = "12"; }), "design_id"));
  EXPECT_TRUE(contains(error_after([](J& j) { j["modules"][0]["i"] = 99999999999ULL; }), "/modules/0/i"));
  EXPECT_TRUE(contains(error_after([](J& j) { j["patches"][0]["entry"] = "x"; }), "/patches/0/entry"));
}

TEST_F(DesignFile, refuses_what_is_not_a_design) {
  for (const char* text : {"", "[]", "{", "null", "{\"format\":\"x\"}", "\xff\xfe", "{\"format\":1e999}"}) {
    EXPECT_NE(error_of(text), "") << text;
  }
  EXPECT_NE(error_of(std::string(1'000'000, '[')), "");
}

TEST_F(DesignFile, design_id_changes_with_wiring_but_not_with_the_report) {
  Design d = two_modules();
  const auto id = design_id_of(d);
  d.report.seconds = 3.0;
  EXPECT_EQ(design_id_of(d), id);
  d.patches[0].modules[1].address = 2;
  EXPECT_NE(design_id_of(d), id);
}

TEST(Taxels, lie_on_the_module_and_turn_with_it) {
  const Design d = two_modules();
  // The up module is unturned: its centroid is (15, h/3, 0) and side 0 runs along x, so taxel 9 is 11.317 mm above the
  // centroid.
  const auto taxels = taxels_of(d.layout.modules[0], 0);
  EXPECT_NEAR(taxels[3].position_mm.x(), 15.0, 1e-9);
  EXPECT_NEAR(taxels[3].position_mm.y(), kHeight_mm / 3, 1e-9);
  EXPECT_NEAR(taxels[9].position_mm.y(), kHeight_mm / 3 + 11.317, 1e-9);
  EXPECT_NEAR(taxels[9].normal.z(), 1.0, 1e-12);
  // Turned by one side, taxel 9 points at the corner opposite to side 1, which is corner 0.
  const auto turned = taxels_of(d.layout.modules[0], 1);
  const Vec3 towards_corner = d.layout.modules[0].corner_mm[0] - turned[3].position_mm;
  EXPECT_NEAR((turned[9].position_mm - turned[3].position_mm).normalized().dot(towards_corner.normalized()), 1.0, 1e-9);
}

}  // namespace
}  // namespace triskin::design
