// SPDX-License-Identifier: GPL-3.0-or-later
// Tests contacts of a stream on a curved cover, and the net force and torque.
#include "triskin/mechanics/surface_contacts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "triskin/base/error.hpp"
#include "triskin/mechanics/inverse.hpp"

namespace triskin::mechanics {
namespace {

constexpr double kCylinder_mm = 35.0;

// Places a taxel on a cylinder about the z axis by its length along the circumference and its height.
Eigen::Vector3d on_cylinder(const Eigen::Vector2d& place) {
  const double angle = place.x() / kCylinder_mm;
  return {kCylinder_mm * std::cos(angle), kCylinder_mm * std::sin(angle), place.y()};
}

Eigen::Vector3d normal_of(const Eigen::Vector3d& position) {
  return Eigen::Vector3d(position.x(), position.y(), 0.0).normalized();
}

ContactEstimate tip(double s, double z, double force, double radius) {
  ContactEstimate contact;
  contact.position_mm = {s, z};
  contact.force_n = force;
  contact.tip_radius_mm = radius;
  return contact;
}

class SurfaceContacts : public testing::Test {
 protected:
  SurfaceContacts() {
    for (int row = 0; row < 12; ++row) {
      for (int k = 0; k < 16; ++k) {
        flat.emplace_back(6.5 * k + 3.25 * (row % 2), 5.63 * row);
        positions.push_back(on_cylinder(flat.back()));
        normals.push_back(normal_of(positions.back()));
      }
    }
  }
  [[nodiscard]] std::vector<double> values_of(const std::vector<ContactEstimate>& contacts, double noise) {
    std::vector<double> values = predict_taxels(table, flat, contacts);
    std::normal_distribution<double> distribution(0.0, 1.0);
    for (double& v : values) v += noise * distribution(engine);
    return values;
  }
  [[nodiscard]] std::vector<SurfaceContact> found_in(const std::vector<double>& values) const {
    return contacts_from_taxels(table, positions, normals, values, {});
  }

  // The table takes most of a second to make, so all tests share it.
  static inline const ContactTable table{{2.0, 0.1, 30.0}};
  std::mt19937_64 engine{11};
  std::vector<Eigen::Vector2d> flat;
  std::vector<Eigen::Vector3d> positions, normals;
};

TEST_F(SurfaceContacts, TwoTipsOnACylinder) {
  const std::vector<ContactEstimate> truth = {tip(30.0, 20.0, 0.9, 25.0), tip(72.0, 41.0, 0.5, 18.0)};
  const auto contacts = found_in(values_of(truth, 0.003));
  ASSERT_EQ(contacts.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const Eigen::Vector3d place = on_cylinder(truth[k].position_mm);
    EXPECT_LT((contacts[k].position_mm - place).norm(), 0.6) << k;
    EXPECT_GT(contacts[k].normal.dot(normal_of(place)), 0.99) << k;
    EXPECT_NEAR(contacts[k].force_n / truth[k].force_n, 1.0, 0.1) << k;
    EXPECT_GE(contacts[k].pressed_taxels, 3) << k;
  }
}

// A second tip that presses on the next taxels belongs to the same group, and one tip does not explain it.
TEST_F(SurfaceContacts, TwoTipsInOneGroup) {
  const std::vector<ContactEstimate> truth = {tip(40.0, 20.0, 0.6, 12.0), tip(55.0, 27.0, 0.6, 12.0)};
  const auto contacts = found_in(values_of(truth, 0.003));
  ASSERT_EQ(contacts.size(), 2U);
  EXPECT_NEAR(contacts[0].force_n + contacts[1].force_n, 1.2, 0.15);
}

TEST_F(SurfaceContacts, DeviationsCoverTheTruth) {
  std::uniform_real_distribution<double> along(15.0, 85.0), up(12.0, 50.0), radius(8.0, 30.0), force(0.4, 0.9);
  constexpr int kDraws = 60;
  int within = 0, found = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const ContactEstimate truth = tip(along(engine), up(engine), force(engine), radius(engine));
    const auto contacts = found_in(values_of({truth}, 0.01));
    if (contacts.size() != 1U) continue;
    ++found;
    within += std::abs(contacts[0].force_n - truth.force_n) < 1.96 * contacts[0].force_sd_n ? 1 : 0;
    // With both axes together, 95 % of a normal distribution in the plane lie within 2.45 deviations of one axis.
    const double distance = (contacts[0].position_mm - on_cylinder(truth.position_mm)).norm();
    within += distance < 2.45 * contacts[0].position_sd_mm ? 1 : 0;
  }
  EXPECT_GE(found, kDraws - 2);
  EXPECT_GT(within, 0.88 * 2 * found);
}

TEST_F(SurfaceContacts, NothingPressedGivesNothing) {
  std::vector<double> values = values_of({}, 0.01);
  EXPECT_TRUE(found_in(values).empty());
  values.assign(values.size(), std::nan(""));
  EXPECT_TRUE(found_in(values).empty());
}

TEST_F(SurfaceContacts, TheStrongestAreKept) {
  const std::vector<ContactEstimate> truth = {tip(20.0, 20.0, 0.3, 12.0), tip(55.0, 20.0, 0.9, 20.0),
                                              tip(85.0, 45.0, 0.5, 15.0)};
  const auto contacts = contacts_from_taxels(table, positions, normals, values_of(truth, 0.003), {.max_contacts = 1});
  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_NEAR(contacts[0].force_n, 0.9, 0.1);
}

TEST_F(SurfaceContacts, SaysWhatDoesNotFit) {
  const std::vector<double> few(3, 0.0), enough(flat.size(), 0.0);
  const auto refused = [&](const auto& call, const char* words) {
    try {
      call();
      ADD_FAILURE() << "taken: " << words;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(words));
    }
  };
  refused([&] { (void)found_in(few); }, "192 positions, 192 normals and 3 values");
  normals[7] *= 2.0;
  refused([&] { (void)found_in(enough); }, "taxel 7");
  normals[7] /= 2.0;
  const SurfaceOptions silent{.noise_dc_over_c = 0.0};
  refused([&] { (void)contacts_from_taxels(table, positions, normals, enough, silent); }, "positive");
}

// By hand: 2 N against +x at (10, 0, 0) and 1 N against +z at (0, 5, 0): force (−2, 0, −1); torque about the origin
// (0, 5, 0) × (0, 0, −1) = (−5, 0, 0), about (0, 0, 1) also (10, 0, −1) × (−2, 0, 0) = (0, 2, 0).
TEST(NetWrench, ByHand) {
  SurfaceContact side, top;
  side.position_mm = {10.0, 0.0, 0.0};
  side.normal = Eigen::Vector3d::UnitX();
  side.force_n = 2.0;
  side.force_sd_n = 0.3;
  side.position_sd_mm = 0.5;
  top.position_mm = {0.0, 5.0, 0.0};
  top.normal = Eigen::Vector3d::UnitZ();
  top.force_n = 1.0;
  top.force_sd_n = 0.4;
  const std::vector<SurfaceContact> contacts = {side, top};
  const Wrench wrench = net_wrench(contacts, Eigen::Vector3d::Zero());
  EXPECT_LT((wrench.force_n - Eigen::Vector3d(-2.0, 0.0, -1.0)).norm(), 1e-12);
  EXPECT_LT((wrench.torque_nmm - Eigen::Vector3d(-5.0, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((wrench.force_sd_n - Eigen::Vector3d(0.3, 0.0, 0.4)).norm(), 1e-12);
  // The terms are 5 mm times 0.4 N about x and 0.5 mm times 2 N about y and z; the side's force adds nothing else,
  // because it passes through the origin.
  EXPECT_LT((wrench.torque_sd_nmm - Eigen::Vector3d(2.0, 1.0, 1.0)).norm(), 1e-12);
  const Wrench about = net_wrench(contacts, {0.0, 0.0, 1.0});
  EXPECT_LT((about.torque_nmm - Eigen::Vector3d(-5.0, 2.0, 0.0)).norm(), 1e-12);
  EXPECT_EQ(net_wrench({}, Eigen::Vector3d::Zero()).force_n.norm(), 0.0);
}

}  // namespace
}  // namespace triskin::mechanics
