// SPDX-License-Identifier: GPL-3.0-or-later
#include "envelope.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "overlap.hpp"
#include "rigid.hpp"

namespace triskin::lattice {
namespace {

constexpr unsigned kSeed = 11;

// Sums of products of random rows, as the relaxing makes them, within random envelopes; Eigen solves the full matrix.
TEST(EnvelopeSystem, solves_what_a_full_factorization_solves) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (int blocks = 1; blocks <= 40; ++blocks) {
    std::vector<int> first;
    for (int k = 0; k < blocks; ++k) first.push_back(static_cast<int>(random() % static_cast<unsigned>(k + 1)));
    EnvelopeSystem system;
    system.reset(first);
    const int rows = 2 * blocks;
    Eigen::MatrixXd full = Eigen::MatrixXd::Identity(rows, rows);
    for (int r = 0; r < rows; ++r) system.add(r, r, 1.0);
    for (int k = 0; k < blocks; ++k) {
      for (int other = first[static_cast<std::size_t>(k)]; other <= k; ++other) {
        Eigen::VectorXd row = Eigen::VectorXd::Zero(rows);
        for (const int c : {2 * other, 2 * other + 1, 2 * k, 2 * k + 1}) row[c] = number(random);
        full += row * row.transpose();
        for (const int r : {2 * k, 2 * k + 1}) {
          for (int c = 2 * other; c <= r; ++c) {
            if (c <= 2 * other + 1 || c >= 2 * k) system.add(r, c, row[r] * row[c]);
          }
        }
        if (other == k) continue;
        for (const int r : {2 * other, 2 * other + 1}) {
          for (int c = 2 * other; c <= r; ++c) system.add(r, c, row[r] * row[c]);
        }
      }
    }
    Eigen::VectorXd right(rows);
    for (int r = 0; r < rows; ++r) right[r] = system.right(r) = number(random);
    system.solve();
    const Eigen::VectorXd expected = full.llt().solve(right);
    for (int r = 0; r < rows; ++r)
      ASSERT_NEAR(system.right(r), expected[r], 1e-12 * rows) << "seed " << kSeed << ", " << blocks << " blocks";
  }
}

// By hand: 4x + 2y = 2, 2x + 5y = 9 have x = -0.5, y = 2.
TEST(EnvelopeSystem, solves_one_block) {
  EnvelopeSystem system;
  system.reset({0});
  system.add(0, 0, 4.0);
  system.add(1, 0, 2.0);
  system.add(1, 1, 5.0);
  system.right(0) = 2.0;
  system.right(1) = 9.0;
  system.solve();
  EXPECT_NEAR(system.right(0), -0.5, 1e-15);
  EXPECT_NEAR(system.right(1), 2.0, 1e-15);
}

NetTriangle module_at(const Vec3& center, const Eigen::Quaterniond& turn) {
  NetTriangle t;
  for (int k = 0; k < 3; ++k) {
    const double angle = 2.0 * M_PI * k / 3.0;
    t.rigid[static_cast<std::size_t>(k)] =
        center + turn * (2.0 * kHeight_mm / 3.0 * Vec3(std::cos(angle), std::sin(angle), 0.0));
  }
  t.center = center;
  t.normal = turn * Vec3::UnitZ();
  return t;
}

// The relaxing and the rules leave a pair alone that is this far apart.
TEST(Overlap, modules_that_are_apart_by_a_distance_do_not_touch_when_one_moves_by_it) {
  std::mt19937 random(kSeed);
  std::normal_distribution<double> gauss;
  int apart = 0;
  for (int k = 0; k < 20'000; ++k) {
    const Eigen::Quaterniond turn(1.0, 0.5 * gauss(random), 0.5 * gauss(random), gauss(random));
    const NetTriangle a = module_at(Vec3::Zero(), Eigen::Quaterniond::Identity()),
                      b = module_at(15.0 * Vec3(gauss(random), gauss(random), 0.2 * gauss(random)), turn.normalized());
    const double apart_mm = overlap_of(a, b).apart_mm;
    if (apart_mm <= 0.0) continue;
    ++apart;
    const Vec3 way = apart_mm * Vec3(gauss(random), gauss(random), gauss(random)).normalized();
    const NetTriangle moved = module_at(b.center + 0.999 * way, turn.normalized());
    ASSERT_EQ(overlap_of(a, moved).depth_mm, 0.0) << "seed " << kSeed << ", pair " << k;
    ASSERT_FALSE(pierced(a.rigid, moved.rigid, 0.0, 0.0)) << "seed " << kSeed << ", pair " << k;
  }
  EXPECT_GT(apart, 3'000);
}

}  // namespace
}  // namespace triskin::lattice
