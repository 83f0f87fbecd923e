// SPDX-License-Identifier: GPL-3.0-or-later
// Joints that the board of a module cannot be bent to, worked by hand from docs/fabrication.md.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "checked_file.hpp"
#include "support/strip_design.hpp"
#include "support/temp_folder.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/design/design_text.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::check {
namespace {

using design::Vec3;

// Half of the arc over 2.856 mm has 1.25 mm: taxels begin there (3.0 - 1.75), and a hole at 1.85 mm has a radius of 0.1
// and stays 0.5 mm away. Beside a cable 0.35 mm are free.
constexpr double kMiddleRadius_mm = 2.856, kJoint_rad = 2.0 * 1.25 / kMiddleRadius_mm,
                 kCable_rad = 2.0 * 0.35 / kMiddleRadius_mm;

// Modules 0 and 1 of a strip, the second one turned about their common side; an entry at `side` of module 0.
std::vector<SharpJoint> sharp_joints_of_pair(double angle_rad, int entry_side) {
  design::Design d = test::strip(2);
  auto& corner = d.layout.modules[1].corner_mm;
  const Vec3 from(30, 0, 0), axis = (Vec3(15, design::kHeight_mm, 0) - from).normalized();
  for (Vec3& p : corner) p = from + Eigen::AngleAxisd(angle_rad, axis) * (p - from);
  for (auto& m : d.patches.front().modules) {
    if (m.parent < 0) m.rotation = entry_side;
  }
  return check_design_text(design::design_text(d), "pair").sharp_joints;
}
int joined_side() {
  const auto& neighbour = test::strip(2).layout.modules[0].neighbour;
  return static_cast<int>(std::ranges::find(neighbour, 1) - neighbour.begin());
}

TEST(SharpJoints, begin_where_a_taxel_or_a_hole_lies_in_the_bend) {
  const int free_side = (joined_side() + 1) % 3;
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_TRUE(sharp_joints_of_pair(sign * (kJoint_rad - 1e-3), free_side).empty());
    const auto sharp = sharp_joints_of_pair(sign * (kJoint_rad + 1e-3), free_side);
    ASSERT_EQ(sharp.size(), 1U);
    EXPECT_EQ(sharp[0].module, (std::array{0, 1}));
    EXPECT_NEAR(sharp[0].bend_rad, kJoint_rad + 1e-3, 1e-6);
    EXPECT_NEAR(sharp[0].limit_rad, kJoint_rad, 1e-9);
    EXPECT_FALSE(sharp[0].has_cable);
  }
}

TEST(SharpJoints, begin_earlier_beside_a_cable) {
  EXPECT_TRUE(sharp_joints_of_pair(kCable_rad - 1e-3, joined_side()).empty());
  const auto sharp = sharp_joints_of_pair(kCable_rad + 1e-3, joined_side());
  ASSERT_EQ(sharp.size(), 1U);
  EXPECT_TRUE(sharp[0].has_cable);
  EXPECT_NEAR(sharp[0].limit_rad, kCable_rad, 1e-9);
}

// A half tube whose radius of 28 mm folds joints across it by about 26 mm / 28 mm, 53°: only a design that asks for
// more than the default has them.
TEST(SharpJoints, are_not_in_a_design_by_default) {
  const test::TempFolder folder;
  const auto part = folder.path() / "tube.obj";
  mesh::write_obj(part, sheet_mesh(40, 20, [](int c, int r) {
                    const double angle_rad = std::numbers::pi * c / 40.0;
                    return Vec3(-28.0 * std::cos(angle_rad), 10.0 * r, 28.0 * std::sin(angle_rad));
                  }));
  pipeline::DesignOptions options;
  options.method = pipeline::SearchMethod::kLattice;
  options.iterations = 60;
  options.time_limit_s = 60.0;
  const auto sharp_joints_of_tube = [&] {
    const design::Design d = pipeline::make_design(part, options).design;
    EXPECT_GT(d.layout.modules.size(), 10U);
    return check_design_text(design::design_text(d), "tube").sharp_joints;
  };
  EXPECT_TRUE(sharp_joints_of_tube().empty());
  options.limits = design::LayoutLimits{};
  EXPECT_FALSE(sharp_joints_of_tube().empty());
}

}  // namespace
}  // namespace triskin::check
