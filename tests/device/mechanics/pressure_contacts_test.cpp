// SPDX-License-Identifier: GPL-3.0-or-later
// These tests find contacts from calibrated taxels. The truth is the exact contact of a sphere on the bonded layer
// (contact_table.hpp), not the footprint that the fit assumes.
#include "triskin/mechanics/pressure_contacts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include "triskin/base/error.hpp"
#include "triskin/mechanics/contact_table.hpp"
#include "triskin/mechanics/taxel.hpp"

namespace triskin::mechanics {
namespace {

const Layer kLayer{2.0, 0.3, 30.0};
constexpr double kNoise_kpa = 0.3, kPressed_kpa = 2.0;

class PressureContacts : public testing::Test {
 protected:
  PressureContacts() {
    for (int row = 0; row < 12; ++row) {
      for (int k = 0; k < 14; ++k) {
        positions.emplace_back(6.5 * k + 3.25 * (row % 2), 5.63 * row, 0.0);
        normals.emplace_back(Eigen::Vector3d::UnitZ());
      }
    }
    kpa.assign(positions.size(), 0.0);
  }
  // Presses a sphere of 20 mm until the contact has the radius, and returns its force.
  double press(const Eigen::Vector3d& at, double radius_mm) {
    const Contact contact = table.press_to_radius({Shape::kSphere, 20.0}, radius_mm);
    const double stiffness = confined_modulus_kpa(kLayer) / kLayer.thickness_mm;
    for (std::size_t t = 0; t < positions.size(); ++t)
      kpa[t] += stiffness * taxel_displacement_mm(contact, (positions[t] - at).norm());
    return contact.force;
  }
  [[nodiscard]] std::vector<PressureContact> found() {
    std::normal_distribution<double> noise(0.0, kNoise_kpa);
    std::vector<double> values = kpa;
    for (double& v : values) v += noise(engine);
    std::vector<std::size_t> pressed;
    for (std::size_t t = 0; t < values.size(); ++t) {
      if (values[t] > kPressed_kpa) pressed.push_back(t);
    }
    return contacts_from_pressure(footprint, positions, normals, values, pressed, {.noise_kpa = kNoise_kpa});
  }
  void release() { kpa.assign(positions.size(), 0.0); }

  static inline const ContactTable table{kLayer};
  static inline const Footprint footprint{kLayer};
  std::mt19937_64 engine{20261125};
  std::vector<Eigen::Vector3d> positions, normals;
  std::vector<double> kpa;
};

// As the sum over the taxels, the force scatters by 10 % over positions; when fitted, by 5 % at most.
TEST_F(PressureContacts, AFingerOf6MmHasPlaceAndForceAnywhere) {
  std::uniform_real_distribution<double> x(20.0, 70.0), y(15.0, 45.0);
  constexpr int kDraws = 80;
  double force_square = 0.0, place_square = 0.0;
  int within = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    release();
    const Eigen::Vector3d at(x(engine), y(engine), 0.0);
    const double force = press(at, 6.0);
    const auto contacts = found();
    ASSERT_EQ(contacts.size(), 1U) << at.transpose();
    const SurfaceContact& c = contacts[0].contact;
    force_square += std::pow(c.force_n / force - 1.0, 2);
    place_square += (c.position_mm - at).squaredNorm();
    within += std::abs(c.force_n - force) < 1.96 * c.force_sd_n ? 1 : 0;
    // For both axes together, 95 % of a normal distribution in the plane lie within 2.45 deviations of one axis.
    within += (c.position_mm - at).norm() < 2.45 * c.position_sd_mm ? 1 : 0;
    EXPECT_NEAR(c.area_mm2, 113.0, 60.0);
  }
  EXPECT_LT(std::sqrt(force_square / kDraws), 0.05);
  EXPECT_LT(std::sqrt(place_square / kDraws), 1.0);
  EXPECT_GE(within, 0.9 * 2 * kDraws);
}

TEST_F(PressureContacts, TwoFingersSideBySideAreTwo) {
  const Eigen::Vector3d left(30.0, 30.0, 0.0), right(47.0, 30.0, 0.0);
  const double force = press(left, 5.0);
  (void)press(right, 5.0);
  const auto contacts = found();
  ASSERT_EQ(contacts.size(), 2U);
  for (const auto& c : contacts) {
    const double distance = std::min((c.contact.position_mm - left).norm(), (c.contact.position_mm - right).norm());
    EXPECT_LT(distance, 1.5);
    EXPECT_NEAR(c.contact.force_n / force, 1.0, 0.2);
    EXPECT_FALSE(c.taxels.empty());
  }
}

// A bag presses 84 taxels at 5 kPa and 39 mm² each: 5·0.039·84 = 16.38 N at their centroid. Three deviations of the
// noise are 3·0.3·0.039·√84 = 0.32 N.
TEST_F(PressureContacts, AWideContactIsTheSumOfItsTaxels) {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  for (std::size_t t = 0; t < 84; ++t) {
    kpa[t] = 5.0;
    centroid += positions[t] / 84.0;
  }
  const auto contacts = found();
  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_NEAR(contacts[0].contact.force_n, 16.38, 0.32);
  EXPECT_LT((contacts[0].contact.position_mm - centroid).norm(), 0.2);
  EXPECT_DOUBLE_EQ(contacts[0].contact.area_mm2, 84 * 39.0);
  EXPECT_EQ(contacts[0].taxels.size(), 84U);
}

// If only one taxel is pressed, the contact is small and lies within half the pitch of it.
TEST_F(PressureContacts, ASingleTaxelIsWithinHalfThePitch) {
  kpa[5 * 14 + 6] = 3.0;
  const auto contacts = found();
  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_LT((contacts[0].contact.position_mm - positions[5 * 14 + 6]).norm(), 3.25);
  EXPECT_EQ(contacts[0].taxels.size(), 1U);
  EXPECT_GT(contacts[0].contact.force_sd_n, 0.02 * contacts[0].contact.force_n);
}

TEST_F(PressureContacts, NothingPressedGivesNothing) {
  EXPECT_TRUE(found().empty());
}

TEST_F(PressureContacts, RefusesBadInput) {
  const std::vector<std::size_t> beyond = {positions.size()};
  const std::vector<std::size_t> none;
  EXPECT_THROW((void)contacts_from_pressure(footprint, positions, normals, kpa, beyond, {}), InputError);
  EXPECT_THROW((void)contacts_from_pressure(footprint, positions, normals, kpa, none, {.noise_kpa = 0.0}), InputError);
  kpa.pop_back();
  EXPECT_THROW((void)contacts_from_pressure(footprint, positions, normals, kpa, none, {}), InputError);
}

}  // namespace
}  // namespace triskin::mechanics
