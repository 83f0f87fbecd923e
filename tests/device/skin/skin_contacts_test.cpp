// SPDX-License-Identifier: GPL-3.0-or-later
// These tests find the contacts of a frame with the function that all readers of a skin share.
#include "triskin/skin/skin_contacts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"

namespace triskin::skin {
namespace {

using layout::kCountsPerKpa;

// Returns the frame of a strip of four modules under a Gaussian pressure in kPa about a point.
ContactFrame frame_of(const design::Vec3& at, double peak_kpa, double width_mm) {
  const design::Design design = test::strip(4);
  const auto wiring = design::wiring_of(design);
  ContactFrame frame;
  for (std::size_t m = 0; m < design.layout.modules.size(); ++m) {
    for (const design::TaxelPose& pose : design::taxels_of(design.layout.modules[m], wiring[m].routed.rotation)) {
      const double share = (pose.position_mm - at).norm() / width_mm;
      frame.position_mm.push_back(pose.position_mm);
      frame.normal.push_back(pose.normal);
      frame.change_counts.push_back(kCountsPerKpa * peak_kpa * std::exp(-0.5 * share * share));
      frame.counts_per_kpa.push_back(kCountsPerKpa);
    }
    frame.taxel_area_mm2.push_back(39.0);
  }
  return frame;
}

// A Gaussian of width s has the force 2π·s²·p: 2π·16 mm²·20 kPa = 2.01 N.
TEST(SkinContacts, APressureHasPlaceForceAndArea) {
  const design::Vec3 at(30.0, 14.0, 0.0);
  const auto contacts = contacts_of(frame_of(at, 20.0, 4.0));
  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_LT((contacts[0].position_mm - at).norm(), 1.0);
  EXPECT_NEAR(contacts[0].force_n, 2.01, 0.3);
  EXPECT_NEAR(contacts[0].normal.z(), 1.0, 1e-6);
  EXPECT_GT(contacts[0].force_sd_n, 0.0);
  EXPECT_GT(contacts[0].position_sd_mm, 0.0);
  EXPECT_GT(contacts[0].area_mm2, 10.0);
  EXPECT_GE(contacts[0].taxels.front().change_counts, contacts[0].taxels.back().change_counts);
}

TEST(SkinContacts, WithoutCalibrationThereIsNoForceButThePlaceIsTheSame) {
  ContactFrame frame = frame_of({30.0, 14.0, 0.0}, 20.0, 4.0);
  const auto calibrated = contacts_of(frame);
  frame.counts_per_kpa.clear();
  const auto counts = contacts_of(frame);
  ASSERT_EQ(counts.size(), 1U);
  EXPECT_TRUE(std::isnan(counts[0].force_n));
  EXPECT_LT((counts[0].position_mm - calibrated[0].position_mm).norm(), 0.01);
  EXPECT_DOUBLE_EQ(counts[0].change_counts, calibrated[0].change_counts);
}

// A pressed taxel without calibration is seen, but its contact has no force.
TEST(SkinContacts, APressedTaxelWithoutCalibrationTakesTheForceAway) {
  ContactFrame frame = frame_of({30.0, 14.0, 0.0}, 20.0, 4.0);
  const auto strongest = std::max_element(frame.change_counts.begin(), frame.change_counts.end());
  frame.counts_per_kpa[static_cast<std::size_t>(strongest - frame.change_counts.begin())] = 0.0;
  const auto contacts = contacts_of(frame);
  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_TRUE(std::isnan(contacts[0].force_n));
}

TEST(SkinContacts, NothingPressedGivesNothing) {
  EXPECT_TRUE(contacts_of(frame_of({30.0, 14.0, 0.0}, 1.0, 4.0)).empty());
  const design::Design design = test::strip(2);
  EXPECT_TRUE(contacts_of(TouchMap(design), design, {}).empty());
}

TEST(SkinContacts, RefusesListsOfOtherLengths) {
  ContactFrame frame = frame_of({30.0, 14.0, 0.0}, 20.0, 4.0);
  frame.taxel_area_mm2.pop_back();
  EXPECT_THROW((void)contacts_of(frame), InputError);
  frame = frame_of({30.0, 14.0, 0.0}, 20.0, 4.0);
  frame.normal.pop_back();
  EXPECT_THROW((void)contacts_of(frame), InputError);
}

// 3 N press down at x = 10 mm and 1 N at x = −10 mm. Worked by hand, the force is −4 N in z; the torque about y is
// −x·F_z, so 10·3 − 10·1 = 20 Nmm. A contact without a force does not count.
TEST(SkinContacts, NetForceAndTorqueAddUp) {
  std::vector<SkinContact> contacts(3);
  for (SkinContact& c : contacts) c.normal = {0.0, 0.0, 1.0};
  contacts[0].position_mm = {10.0, 0.0, 0.0};
  contacts[0].force_n = 3.0;
  contacts[1].position_mm = {-10.0, 0.0, 0.0};
  contacts[1].force_n = 1.0;
  contacts[2].force_n = std::nan("");
  const NetForce net = net_force(contacts);
  EXPECT_DOUBLE_EQ(net.force_n.z(), -4.0);
  EXPECT_DOUBLE_EQ(net.torque_nmm.y(), 20.0);
  EXPECT_DOUBLE_EQ(net.torque_nmm.x(), 0.0);
}

}  // namespace
}  // namespace triskin::skin
