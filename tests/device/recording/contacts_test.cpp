// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the grouping of taxels into contacts by examples worked by hand.
#include <gtest/gtest.h>

#include "triskin/recording/cdr.hpp"
#include "triskin/recording/messages.hpp"

namespace triskin::recording {
namespace {

constexpr double kModule_mm2 = 390.0;  // A module has 39 mm² per taxel for pressure.

PressedTaxel taxel(int module, int number, double change, double x_mm, double z_mm = 0.0, double normal_z = 1.0) {
  return {layout::ModuleId{module}, layout::TaxelIndex{number}, change, {x_mm, 0.0, z_mm}, {0.0, 0.0, normal_z}};
}

TEST(Contacts, chains_of_near_taxels_are_one_and_its_middle_is_weighted) {
  // The taxels at 0, 12 and 24 are each linked to the next one, but 36.1 is not.
  const std::vector<PressedTaxel> taxels{taxel(0, 0, 100.0, 0.0), taxel(1, 3, 300.0, 24.0), taxel(0, 1, 200.0, 12.0),
                                         taxel(1, 4, 500.0, 36.1)};
  const auto contacts = gather_contacts(taxels, kModule_mm2);
  ASSERT_EQ(contacts.size(), 2U);
  EXPECT_EQ(contacts[0].change_counts, 600.0);
  EXPECT_DOUBLE_EQ(contacts[0].position_mm.x(), (0.0 * 100 + 12.0 * 200 + 24.0 * 300) / 600.0);
  EXPECT_EQ(contacts[0].normal.z(), 1.0);
  EXPECT_DOUBLE_EQ(contacts[0].area_mm2, 3 * 39.0);
  ASSERT_EQ(contacts[0].taxels.size(), 3U);
  EXPECT_EQ(contacts[0].taxels[0].change_counts, 300.0);
  EXPECT_EQ(contacts[1].taxels[0].taxel, 4);
}

TEST(Contacts, two_sides_of_a_thin_part_are_two) {
  const std::vector<PressedTaxel> taxels{taxel(0, 0, 400.0, 0.0), taxel(9, 0, 300.0, 0.0, -8.0, -1.0)};
  EXPECT_EQ(gather_contacts(taxels, kModule_mm2).size(), 2U);
}

TEST(Contacts, temperature_is_no_contact) {
  const std::vector<PressedTaxel> taxels{taxel(0, 6, 400.0, 0.0), taxel(0, 10, 400.0, 30.0)};
  EXPECT_TRUE(gather_contacts(taxels, kModule_mm2).empty());
  EXPECT_TRUE(gather_contacts({}, kModule_mm2).empty());
}

TEST(Contacts, a_force_says_its_unit) {
  const std::vector<PressedTaxel> taxels{taxel(0, 0, 400.0, 0.0)};
  const auto contacts = gather_contacts(taxels, kModule_mm2);
  for (const auto& [newton_per_count, unit, force] : {std::tuple{0.0, "counts", 400.0}, std::tuple{0.005, "N", 2.0}}) {
    const auto message = encode_contacts(contacts, 1, "f", {.newton_per_count = newton_per_count});
    CdrReader r(message);
    (void)r.u32(), (void)r.u32();
    EXPECT_EQ(r.text(), "f");
    EXPECT_EQ(r.text(), unit);
    EXPECT_EQ(r.count(1), 1U);
    for (int k = 0; k < 6; ++k) (void)r.f64();
    EXPECT_EQ(r.f64(), force);
    EXPECT_DOUBLE_EQ(r.f64(), 39e-6);
    EXPECT_EQ(r.count(4), 1U);
  }
}

// Two taxels have their own sensitivities: 0.1 N and 0.25 N are 0.35 N, whatever their counts.
TEST(Contacts, a_force_by_taxels_is_their_sum) {
  std::vector<PressedTaxel> taxels{taxel(0, 0, 400.0, 0.0), taxel(0, 1, 300.0, 6.0)};
  taxels[0].force_n = 0.1;
  taxels[1].force_n = 0.25;
  const auto contacts = gather_contacts(taxels, kModule_mm2);
  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_DOUBLE_EQ(contacts[0].force_n, 0.35);
  const auto message = encode_contacts(contacts, 1, "f", {.newton_per_count = 7.0, .by_taxel = true});
  CdrReader r(message);
  (void)r.u32(), (void)r.u32();
  (void)r.text();
  EXPECT_EQ(r.text(), "N");
  (void)r.count(1);
  for (int k = 0; k < 6; ++k) (void)r.f64();
  EXPECT_DOUBLE_EQ(r.f64(), 0.35);
}

}  // namespace
}  // namespace triskin::recording
