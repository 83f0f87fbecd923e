// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the limits of lift and depth of corners and sides: modules that are tilted or bridge a groove must be found,
// and must not be made.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "checked_file.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/design/design.hpp"
#include "triskin/lattice/map_modules.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::check {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::Not;
namespace fs = std::filesystem;

constexpr double kPeriod_mm = 44.0, kGroove_mm = 8.0;

// The sheet is 176 mm by 120 mm; its height is a cosine from 0 to kGroove_mm, or 0 everywhere.
design::Mesh sheet(double groove_mm) {
  return sheet_mesh(88, 12, [=](int c, int r) {
    const double x = 2.0 * c;
    return design::Vec3(x, 10.0 * r, 0.5 * groove_mm * (1.0 + std::cos(2.0 * M_PI * x / kPeriod_mm)));
  });
}

class Lift : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("lift." + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  json design_of(double groove_mm, double lift_mm, double depth_mm) {
    mesh::write_obj(folder_ / "sheet.obj", sheet(groove_mm));
    pipeline::DesignOptions options;
    options.iterations = 60;
    options.time_limit_s = 60.0;
    options.limits.lift_mm = lift_mm;
    options.limits.depth_mm = depth_mm;
    const design::Design d = pipeline::make_design(folder_ / "sheet.obj", options).design;
    design::write_design(folder_ / "design.json", d);
    return json::parse(read_file(folder_ / "design.json"));
  }
  std::vector<Violation> violations(const json& j) { return violations_of(j, folder_ / "checked.json"); }
  std::vector<std::string> broken(const json& j) { return broken_rules(j, folder_ / "checked.json"); }

  fs::path folder_;
};

double highest(const json& j, const char* key) {
  double most = 0.0;
  for (const json& m : j["modules"]) most = std::max(most, m[key].get<double>());
  return most;
}

TEST_F(Lift, grooves_are_bridged_only_as_far_as_the_limits_allow) {
  json loose = design_of(kGroove_mm, 20.0, 20.0);
  EXPECT_THAT(broken(loose), testing::IsEmpty());
  EXPECT_GT(std::max(highest(loose, "edge_lift_mm"), highest(loose, "edge_depth_mm")), 4.5);
  loose["limits"]["lift_mm"] = 3.5;
  loose["limits"]["depth_mm"] = 4.5;
  EXPECT_THAT(broken(loose), testing::Each(testing::AnyOf("edge-lift", "edge-depth")));
  EXPECT_THAT(broken(loose), Not(testing::IsEmpty()));

  const json kept = design_of(kGroove_mm, 2.5, 2.5);
  EXPECT_THAT(broken(kept), testing::IsEmpty());
  EXPECT_GE(kept["modules"].size(), 4U);
  EXPECT_LT(kept["modules"].size(), loose["modules"].size());
  EXPECT_LE(highest(kept, "edge_lift_mm"), 2.5);
  EXPECT_LE(highest(kept, "edge_depth_mm"), 2.5);
  EXPECT_EQ(kept["report"]["max_edge_lift_mm"], highest(kept, "edge_lift_mm"));
}

// A free module on a plane is turned by 30° about the parallel to a side through its centre: the opposite corner is
// 2h/3 · sin 30° = 8.66 mm above the surface, the side h/3 · sin 30° = 4.33 mm deep.
TEST_F(Lift, a_module_tilted_by_30_degrees_is_found_and_measured) {
  json j = design_of(0.0, 3.5, 4.5);
  EXPECT_THAT(broken(j), testing::IsEmpty());
  EXPECT_LT(highest(j, "edge_lift_mm"), 0.01);
  json& m = j["modules"][0];
  std::array<std::array<double, 3>, 3> p = m["corners"];
  const std::array<double, 3> center{(p[0][0] + p[1][0] + p[2][0]) / 3, (p[0][1] + p[1][1] + p[2][1]) / 3, 0.0};
  const double sx = (p[1][0] - p[0][0]) / 30.0, sy = (p[1][1] - p[0][1]) / 30.0;  // The direction is along the side.
  for (auto& c : p) {
    const double across = -(c[0] - center[0]) * sy + (c[1] - center[1]) * sx;
    const double shrink = across * (1.0 - std::cos(M_PI / 6));
    c = {c[0] + shrink * sy, c[1] - shrink * sx, across * 0.5};
  }
  m["corners"] = p;
  std::string lift;
  for (const Violation& v : violations(j)) {
    const bool is_limit = v.text.find("limit") != std::string::npos;
    EXPECT_FALSE(v.rule == "edge-depth" && is_limit) << v.text;
    EXPECT_NE(v.rule, "center-gap");
    if (v.rule == "edge-lift" && is_limit) lift = v.text;
  }
  EXPECT_EQ(lift.substr(0, 8), "8.660 mm") << lift;
}

// A module that tilts, or bridges a groove, is dropped with that reason when pieces are mapped back to the surface.
TEST(KeepLimits, lift_and_depth_are_among_them) {
  const mesh::Surface plane(sheet(0.0));
  const auto tilted = [](double degrees) {
    const double turn = degrees * M_PI / 180.0, h = design::kHeight_mm, up = std::sin(turn), along = std::cos(turn);
    design::PlacedModule m;
    m.corner_mm = {design::Vec3(65, 60 - h / 3 * along, -h / 3 * up), design::Vec3(95, 60 - h / 3 * along, -h / 3 * up),
                   design::Vec3(80, 60 + 2 * h / 3 * along, 2 * h / 3 * up)};
    return m;
  };
  const auto refused_by = [&](double degrees, double lift_mm, double depth_mm) -> std::string {
    design::LayoutLimits limits;
    limits.lift_mm = lift_mm;
    limits.depth_mm = depth_mm;
    design::ModuleLayout layout;
    layout.modules = {tilted(degrees)};
    lattice::keep_limits(plane, limits, layout);
    return layout.refused.empty() ? "" : layout.refused[0].first;
  };
  // The lift is 2h/3 sin 10° = 3.008 mm, and the depth is h/3 sin 10° = 1.504 mm.
  EXPECT_EQ(refused_by(10.0, 3.1, 1.6), "");
  EXPECT_EQ(refused_by(10.0, 3.0, 1.6), "lift_mm");
  EXPECT_EQ(refused_by(-10.0, 1.6, 3.0), "depth_mm");
  EXPECT_EQ(refused_by(-10.0, 1.6, 3.1), "");
}

// Two sheets cross and face away from each other (their normals are 120° apart): one module passes through the other,
// which the overlap of their bodies says.
TEST(KeepLimits, no_module_passes_through_another_in_space) {
  using design::Vec3;
  const auto point = [](bool is_steep, double along_mm, double y_mm) {
    const double angle = is_steep ? 2.0 * M_PI / 3.0 : 0.0;
    return Vec3(along_mm * std::cos(angle), y_mm, along_mm * std::sin(angle));
  };
  design::Mesh sheets;
  for (const bool is_steep : {false, true}) {
    const int first = static_cast<int>(sheets.vertices.size());
    for (const auto& [x, y] : {std::pair{-100.0, -100.0}, {100.0, -100.0}, {100.0, 100.0}, {-100.0, 100.0}})
      sheets.vertices.push_back(point(is_steep, x, y));
    sheets.faces.push_back({first, first + 1, first + 2});
    sheets.faces.push_back({first, first + 2, first + 3});
  }
  const mesh::Surface surface(sheets);
  const auto module_at = [&](bool is_steep, double center_mm) {
    constexpr double kThird_mm = design::kHeight_mm / 3.0, kHalf_mm = design::kSide_mm / 2.0;
    design::PlacedModule m;
    m.corner_mm = {point(is_steep, center_mm - kThird_mm, kHalf_mm), point(is_steep, center_mm - kThird_mm, -kHalf_mm),
                   point(is_steep, center_mm + 2.0 * kThird_mm, 0.0)};
    return m;
  };
  const auto refused = [&](double center_mm, double corner_cut_mm) {
    design::ModuleLayout layout;
    layout.corner_cut_mm = corner_cut_mm;
    layout.modules = {module_at(false, 6.0), module_at(true, center_mm)};
    lattice::keep_limits(surface, {}, layout);
    EXPECT_EQ(layout.modules.size() + layout.refused.size(), 2u);
    return layout.refused;
  };
  const std::vector<std::pair<std::string, int>> one_overlaps{{"penetration_mm", 1}};
  for (const double cut_mm : {0.0, 3.0}) {
    EXPECT_EQ(refused(3.0, cut_mm), one_overlaps);
    // Its nearest side lies 9.3 mm beyond the line where the sheets cross.
    EXPECT_TRUE(refused(18.0, cut_mm).empty());
  }
}

TEST_F(Lift, a_design_without_its_limits_is_refused) {
  const json whole = design_of(kGroove_mm, 20.0, 20.0);
  EXPECT_THAT(broken(whole), testing::IsEmpty());
  for (const char* key : {"lift_mm", "depth_mm"}) {
    json without = whole;
    without["limits"].erase(key);
    EXPECT_THROW((void)violations(without), InputError) << key;
  }
}

}  // namespace
}  // namespace triskin::check
