// SPDX-License-Identifier: GPL-3.0-or-later
// These tests check the footprint of a contact in the linear limit.
#include "triskin/mechanics/footprint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "triskin/base/error.hpp"
#include "triskin/mechanics/contact_table.hpp"
#include "triskin/mechanics/taxel.hpp"

namespace triskin::mechanics {
namespace {

constexpr double kKpaMm2 = 1000.0;  // This is one newton.

// ∫ p dA = F holds for any contact: the values of calibrated taxels add up to the force (Simpson's rule over rings).
TEST(Footprint, IntegralIsTheForce) {
  for (const double poisson : {0.0, 0.3, 0.45}) {
    const Footprint footprint({2.0, poisson, 30.0});
    for (const double radius : {1.5, 4.0, 6.0, 15.0}) {
      constexpr int kSteps = 4000;
      const double reach = footprint.reach_mm(radius), step = reach / kSteps;
      double sum = 0.0;
      for (int k = 0; k <= kSteps; ++k) {
        const double weight = k == 0 || k == kSteps ? 1.0 : k % 2 == 1 ? 4.0 : 2.0;
        sum += weight * k * step * footprint.kpa_per_newton(radius, k * step);
      }
      // The pressure beyond the reach is below 0.02 % of the peak, over a ring of about 20 mm.
      EXPECT_NEAR(2.0 * std::numbers::pi * sum * step / 3.0 / kKpaMm2, 1.0, 0.02) << poisson << " " << radius;
    }
  }
}

// A thin layer under small electrodes spreads nothing: for 1 N at s = r/a the pressures are 1500/(πa²)·√(1 −
// s²) and 2000/(πa²)·(1 − s²) kPa, the latter with the share a/(a + 3h). The transforms end at a wave number
// of 12/mm, which costs some 1 %.
TEST(Footprint, ThinLayerShowsThePressure) {
  const Footprint footprint({0.2, 0.0, 30.0}, 0.2);
  for (const double radius : {6.0, 10.0}) {
    const double wide = radius / (radius + 0.6), unit = kKpaMm2 / (std::numbers::pi * radius * radius);
    for (const double share : {0.0, 0.3, 0.6, 0.8})
      EXPECT_NEAR(footprint.kpa_per_newton(radius, share * radius) / unit,
                  (1.0 - wide) * 1.5 * std::sqrt(1.0 - share * share) + wide * 2.0 * (1.0 - share * share), 0.02)
          << share;
  }
}

// The taxel values under the exact contact of a sphere differ by only some percent of the peak. The reference comes
// from the dual integral equations of the table, which share no code with the footprint.
TEST(Footprint, IsNearTheExactContact) {
  const Layer layer{2.0, 0.3, 30.0};
  const ContactTable table(layer);
  const Footprint footprint(layer);
  for (const double radius : {4.0, 6.0}) {
    const Contact contact = table.press_to_radius({Shape::kSphere, 20.0}, radius);
    const double stiffness = confined_modulus_kpa(layer) / layer.thickness_mm;
    const double peak = contact.force * footprint.kpa_per_newton(radius, 0.0);
    for (double r = 0.0; r < 14.0; r += 1.0) {
      EXPECT_NEAR(contact.force * footprint.kpa_per_newton(radius, r), stiffness * taxel_displacement_mm(contact, r),
                  0.1 * peak)
          << radius << " " << r;
    }
  }
}

TEST(Footprint, RefusesWhatIsNoLayer) {
  EXPECT_THROW(Footprint({2.0, 0.5, 30.0}), InputError);
  EXPECT_THROW(Footprint({0.0, 0.3, 30.0}), InputError);
  EXPECT_THROW(Footprint({2.0, 0.3, 30.0}, 0.0), InputError);
}

}  // namespace
}  // namespace triskin::mechanics
