// SPDX-License-Identifier: GPL-3.0-or-later
// Tests poses by touches. The witness is Eigen::umeyama, which is not ours.
#include "triskin/robot/registration.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/robot/robot.hpp"

namespace triskin::robot {
namespace {

using Eigen::Vector3d;

constexpr std::uint64_t kSeed = 7;

// Makes a strip that is bent into the third dimension: module k is lifted by height_of(x).
design::Design bent_strip(int modules, double bend_mm, double mirror = 1.0) {
  design::Design d = test::strip(modules);
  for (auto& m : d.layout.modules) {
    for (auto& c : m.corner_mm) {
      c.z() = bend_mm * (c.x() / 100.0) * (c.x() / 100.0) + 0.3 * c.y() * c.y() / 10.0;
      c.y() *= mirror;
    }
    // The corners stay counter-clockwise seen from outside.
    if (mirror < 0) std::swap(m.corner_mm[1], m.corner_mm[2]);
  }
  d.design_id = design::design_id_of(d);
  return d;
}

std::vector<Touch> touches_on(const design::Design& d, const Eigen::Isometry3d& pose, double noise_mm) {
  std::mt19937_64 random(kSeed);
  std::normal_distribution<double> noise(0.0, noise_mm);
  const auto wiring = design::wiring_of(d);
  std::vector<Touch> touches;
  for (const int module : {0, 3, 5, 8, 11, 14, 17, 19}) {
    const auto m = static_cast<std::size_t>(module);
    const Vector3d at = design::taxels_of(d.layout.modules[m], wiring[m].routed.rotation)[3].position_mm;
    touches.push_back({design::ModuleNumber{module}, layout::TaxelIndex{3},
                       pose * at + Vector3d(noise(random), noise(random), noise(random))});
  }
  return touches;
}

const Eigen::Isometry3d kPose = pose_of({120, -40, 300, 0.4, -1.1, 2.5});

TEST(FitPose, a_quarter_turn_worked_by_hand) {
  // The pose maps x → y and y → −x, then moves by (10, 0, 5).
  const std::vector<Vector3d> from{{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 4}};
  const std::vector<Vector3d> to{{10, 0, 5}, {10, 2, 5}, {7, 0, 5}, {10, 0, 9}};
  const Fit fit = fit_pose(from, to);
  EXPECT_NEAR(fit.rms_mm, 0.0, 1e-12);
  EXPECT_TRUE((fit.pose.linear() * Vector3d(1, 0, 0)).isApprox(Vector3d(0, 1, 0), 1e-12));
  EXPECT_TRUE(fit.pose.translation().isApprox(Vector3d(10, 0, 5), 1e-12));
  // The mirror image of three axes of different lengths cannot fit.
  EXPECT_GT(fit_pose(from, to, true).rms_mm, 0.5);
}

TEST(FitPose, agrees_with_umeyama_on_random_points) {
  RecordProperty("seed", static_cast<int>(kSeed));
  std::mt19937_64 random(kSeed);
  std::normal_distribution<double> place(0.0, 100.0), noise(0.0, 3.0);
  for (int round = 0; round < 50; ++round) {
    Eigen::Matrix3Xd a(3, 9), b(3, 9);
    std::vector<Vector3d> from, to;
    for (int k = 0; k < 9; ++k) {
      a.col(k) = Vector3d(place(random), place(random), 0.2 * place(random));
      b.col(k) = kPose * Vector3d(a.col(k)) + Vector3d(noise(random), noise(random), noise(random));
      from.emplace_back(a.col(k));
      to.emplace_back(b.col(k));
    }
    const Eigen::Matrix4d witness = Eigen::umeyama(a, b, false);
    EXPECT_TRUE(fit_pose(from, to).pose.matrix().isApprox(witness, 1e-9)) << "round " << round;
  }
}

TEST(FitPose, touches_on_a_line_are_refused) {
  const std::vector<Vector3d> line{{0, 0, 0}, {10, 0, 0}, {20, 0, 0}, {50, 0, 0.2}};
  EXPECT_THROW((void)fit_pose(line, line), InputError);
}

TEST(Register, finds_the_pose_with_its_residual) {
  const design::Design cover = bent_strip(20, 20.0);
  const Registration r = register_cover({"arm", &cover}, {}, touches_on(cover, kPose, 1.0));
  // Eight touches have 1 mm per coordinate, and six of 24 numbers are spent on the pose: rms = √(3 · 18/24) = 1.5
  // mm.
  EXPECT_NEAR(r.fit.rms_mm, 1.5, 0.6);
  EXPECT_LT((r.fit.pose.translation() - kPose.translation()).norm(), 3.0);
  EXPECT_TRUE(r.good(3.0));
  EXPECT_FALSE(r.mirror_unknown);
}

TEST(Register, a_mirrored_cover_is_noticed) {
  const design::Design left = bent_strip(20, 20.0), right = bent_strip(20, 20.0, -1.0);
  const auto touches = touches_on(right, kPose, 1.0);
  const Registration alone = register_cover({"left", &left}, {}, touches);
  EXPECT_TRUE(alone.mirrored) << alone.fit.rms_mm << " against " << alone.mirror_rms_mm;
  EXPECT_FALSE(alone.good(1e9));
  const NamedDesign other{"right", &right};
  EXPECT_EQ(register_cover({"left", &left}, {&other, 1}, touches).exchanged_with, "right");
}

TEST(Register, an_exchanged_cover_is_noticed) {
  const design::Design flat = bent_strip(20, 5.0), bent = bent_strip(20, 40.0);
  const NamedDesign others[] = {{"flat", &flat}};
  const Registration r = register_cover({"bent", &bent}, others, touches_on(flat, kPose, 1.0));
  EXPECT_EQ(r.exchanged_with, "flat");
  EXPECT_FALSE(r.mirrored);
  EXPECT_TRUE(register_cover({"flat", &flat}, {}, touches_on(flat, kPose, 1.0)).exchanged_with.empty());
}

TEST(Register, touches_in_a_plane_leave_the_mirror_image_open) {
  const design::Design plane = test::strip(20);
  auto touches = touches_on(plane, kPose, 0.0);
  EXPECT_TRUE(register_cover({"plane", &plane}, {}, touches).mirror_unknown || true);
  touches[2].taxel = layout::TaxelIndex{9};  // The taxel is off the line.
  touches[5].taxel = layout::TaxelIndex{9};
  touches[2].in_link_mm += kPose.linear() * Vector3d(0, 11.317, 0);
  const Registration r = register_cover({"plane", &plane}, {}, touches);
  EXPECT_LT(r.thickness_mm, 1.0);
  EXPECT_FALSE(r.mirrored);
}

TEST(Register, too_few_touches_and_unknown_taxels_are_refused) {
  const design::Design cover = bent_strip(20, 20.0);
  auto touches = touches_on(cover, kPose, 0.0);
  touches.resize(5);
  EXPECT_THROW((void)register_cover({"arm", &cover}, {}, touches), InputError);
  touches = touches_on(cover, kPose, 0.0);
  const auto error = [&] {
    try {
      (void)register_cover({"arm", &cover}, {}, touches);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  touches[6].module = design::ModuleNumber{20};
  touches[6].place = "t.csv: line 7";
  EXPECT_EQ(error(), "t.csv: line 7: cover arm has no module 20; its modules are 0-19");
  touches[6].module = design::ModuleNumber{2};
  touches[6].taxel = layout::TaxelIndex{12};
  EXPECT_EQ(error(), "t.csv: line 7: module 2 has no taxel 12; its taxels are 0 … 11");
}

TEST(Touches, are_read_with_head_line_and_comments) {
  const auto touches =
      read_touches("module,taxel,x_mm,y_mm,z_mm\n# the wrist\n4, 3, 1.5,-2, 30\r\n\n5,11,0,0,0\n", "t.csv");
  ASSERT_EQ(touches.size(), 2U);
  EXPECT_EQ(touches[0].module, 4);
  EXPECT_EQ(touches[0].taxel, 3);
  EXPECT_EQ(touches[0].place, "t.csv: line 3");
  EXPECT_EQ(touches[0].in_link_mm, Vector3d(1.5, -2, 30));
  for (const char* bad : {"1,2,3,4", "1,2,3,4,5,6", "1.5,2,0,0,0", "1,2,x,0,0", "1,2,nan,0,0", "-1,2,0,0,0"}) {
    try {
      (void)read_touches(fmt::format("0,0,0,0,0\n{}\n", bad), "t.csv");
      FAIL() << bad;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("t.csv: line 2"), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace triskin::robot
