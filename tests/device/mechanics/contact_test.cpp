// SPDX-License-Identifier: GPL-3.0-or-later
// Tests laws that hold for every contact, limits that are known in closed form, and refused input.
#include "triskin/mechanics/contact.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "device/mechanics/src/bonded_layer.hpp"
#include "triskin/base/error.hpp"
#include "triskin/mechanics/contact_table.hpp"
#include "triskin/mechanics/layer.hpp"
#include "triskin/mechanics/taxel.hpp"

namespace triskin::mechanics {
namespace {

using std::numbers::pi;

// Simpson's rule shares nothing with the Gauss rules of the code.
double simpson(double from, double to, int steps, const std::function<double(double)>& f) {
  const double step = (to - from) / (2 * steps);
  double sum = f(from) + f(to);
  for (int k = 1; k < 2 * steps; ++k) sum += (k % 2 == 1 ? 4.0 : 2.0) * f(from + k * step);
  return sum * step / 3.0;
}

double over_plane(double edge, double reach, const std::function<double(double)>& f) {
  const auto ring = [&](double r) { return 2.0 * pi * r * f(r); };
  return simpson(0.0, edge, 200, ring) + simpson(edge, edge + reach, 600, ring);
}

// By hand with E 100 and ν 0.25, K is 100 · 0.75 / (1.25 · 0.5) = 120.
TEST(Layer, ConfinedModulusByHand) {
  EXPECT_DOUBLE_EQ(confined_modulus_kpa({2.0, 0.25, 100.0}), 120.0);
}

// Long waves compress columns: c₀ · M(α) / α → 1/K. Short waves see a half-space, and their pressure stays near
// the surface.
TEST(Layer, KernelHasBothLimits) {
  const Layer layer{1.0, 0.25, 100.0};
  const double alpha = 1e-3;
  EXPECT_NEAR(half_space_compliance_per_kpa(layer) * compliance_ratio(alpha, 0.25) / alpha * 120.0, 1.0, 1e-5);
  EXPECT_NEAR(base_pressure_ratio(alpha, 0.25), 1.0, 1e-5);
  EXPECT_NEAR(compliance_ratio(30.0, 0.25), 1.0, 1e-12);
  EXPECT_NEAR(compliance_ratio(0.7, 0.25) + compliance_deficit(0.7, 0.25), 1.0, 1e-14);
  EXPECT_LT(base_pressure_ratio(30.0, 0.25), 1e-10);
}

struct Material {
  double poisson;
  Indenter indenter;
};

void PrintTo(const Material& material, std::ostream* out) {
  *out << "Poisson " << material.poisson << ", radius " << material.indenter.radius_mm << " mm";
}

class Balance : public testing::TestWithParam<Material> {};

// ∫ u dA = F·h / K and ∫ base pressure dA = F hold exactly for every contact on a linear layer.
TEST_P(Balance, DisplacementAndBasePressureAddUpToTheForce) {
  const Layer layer{2.0, GetParam().poisson, 100.0};
  const double force = 0.8;
  const Contact contact = press_bonded(layer, GetParam().indenter, force);
  const double edge = contact.contact_radius_mm, reach = 30.0;
  const double volume = over_plane(edge, reach, [&](double r) { return contact.field->displacement_mm(r); });
  const double load = over_plane(edge, reach, [&](double r) { return contact.field->base_pressure_kpa(r); });
  const double expected = 1000.0 * force * layer.thickness_mm / confined_modulus_kpa(layer);
  // A punch has a corner in its displacement, for which Simpson's rule is good to a few parts in a thousand.
  const double tolerance = GetParam().indenter.shape == Shape::kFlatPunch ? 5e-3 : 2e-4;
  EXPECT_NEAR(volume / expected, 1.0, tolerance);
  EXPECT_NEAR(load / (1000.0 * force), 1.0, 2e-4);
}

INSTANTIATE_TEST_SUITE_P(Materials, Balance,
                         testing::Values(Material{0.1, {Shape::kSphere, 4.0}}, Material{0.3, {Shape::kSphere, 20.0}},
                                         Material{0.45, {Shape::kParaboloid, 10.0}},
                                         Material{0.3, {Shape::kFlatPunch, 3.0}},
                                         Material{0.1, {Shape::kFlatPunch, 2.0}}));

TEST(BondedLine, DisplacementAndBasePressureAddUpToTheForce) {
  const Layer layer{2.0, 0.3, 100.0};
  const double force = 0.1;
  const Contact contact = press_bonded(layer, {Shape::kLine, 8.0}, force);
  const double edge = contact.contact_radius_mm;
  const auto both_sides = [&](const std::function<double(double)>& f) {
    return 2.0 * (simpson(0.0, edge, 200, f) + simpson(edge, edge + 30.0, 600, f));
  };
  const double expected = 1000.0 * force * 2.0 / confined_modulus_kpa(layer);
  EXPECT_NEAR(both_sides([&](double x) { return contact.field->displacement_mm(x); }) / expected, 1.0, 1e-4);
  EXPECT_NEAR(both_sides([&](double x) { return contact.field->base_pressure_kpa(x); }) / (1000.0 * force), 1.0, 1e-4);
}

// On a layer that is thick compared with the contact Hertz holds: a³ = 3FR / 4E*, δ = a² / R, p = 3F / 2πa².
TEST(BondedLayer, ThickLayerIsHertz) {
  const Layer layer{100.0, 0.3, 100.0};
  const double force = 1e-3, radius = 5.0;
  const Contact contact = press_bonded(layer, {Shape::kParaboloid, radius}, force);
  const double reduced = 100.0 / (1.0 - 0.09);
  const double a = std::cbrt(0.75 * 1000.0 * force * radius / reduced);
  // The effect of the layer is of the order a/h, 0.3 %.
  EXPECT_NEAR(contact.contact_radius_mm / a, 1.0, 0.005);
  EXPECT_NEAR(contact.indentation_mm / (a * a / radius), 1.0, 0.01);
  EXPECT_NEAR(contact.peak_pressure_kpa / (1.5 * 1000.0 * force / (pi * a * a)), 1.0, 0.005);
}

// A flat punch on a thick layer has F = 2E*aδ and half of the mean pressure in its centre (Boussinesq).
TEST(BondedLayer, ThickLayerUnderAPunchIsBoussinesq) {
  const Layer layer{200.0, 0.3, 100.0};
  const Contact contact = press_bonded(layer, {Shape::kFlatPunch, 1.0}, 0.01);
  const double reduced = 100.0 / (1.0 - 0.09);
  EXPECT_NEAR(contact.indentation_mm / (10.0 / (2.0 * reduced)), 1.0, 0.01);
  EXPECT_NEAR(contact.peak_pressure_kpa / (10.0 / (2.0 * pi)), 1.0, 0.01);
}

// Under a contact that is wide compared with the layer the columns are independent; the difference falls as h/a.
TEST(BondedLayer, WideContactIsWinkler) {
  const Layer layer{1.0, 0.2, 100.0};
  const Indenter indenter{Shape::kParaboloid, 2000.0};
  const Contact exact = press(Level::kFft, layer, indenter, 60.0);
  const Contact winkler = press(Level::kWinkler, layer, indenter, 60.0);
  ASSERT_GT(exact.contact_radius_mm, 20.0);
  EXPECT_NEAR(winkler.indentation_mm / exact.indentation_mm, 1.0, 0.01);
  EXPECT_NEAR(winkler.contact_radius_mm / exact.contact_radius_mm, 1.0, 0.03);
}

// By hand: h 2, E 100, ν 0 give K 100. A punch of 10 mm² area at 0.1 N has 10 kPa: Winkler 0.2 mm; columns with a
// logarithm 2·(1 − e^−0.1) = 0.190325 mm.
TEST(Foundations, PunchByHand) {
  const Layer layer{2.0, 0.0, 100.0};
  const Indenter punch{Shape::kFlatPunch, std::sqrt(10.0 / pi)};
  EXPECT_NEAR(press(Level::kWinkler, layer, punch, 0.1).indentation_mm, 0.2, 1e-12);
  EXPECT_NEAR(press(Level::kLogarithmic, layer, punch, 0.1).indentation_mm, 0.1903251639, 1e-9);
}

// Compares the closed forms with Simpson's rule over the pressure that the field states.
TEST(Foundations, PressureAddsUpToTheForce) {
  const Layer layer{2.0, 0.3, 100.0};
  for (const Level level : {Level::kWinkler, Level::kLogarithmic}) {
    for (const Shape shape : {Shape::kSphere, Shape::kParaboloid, Shape::kFlatPunch}) {
      const Contact contact = press(level, layer, {shape, 5.0}, 1.5);
      const auto ring = [&](double r) { return 2.0 * pi * r * contact.field->base_pressure_kpa(r); };
      EXPECT_NEAR(simpson(0.0, contact.contact_radius_mm, 400, ring), 1500.0, 1.0) << static_cast<int>(shape);
    }
    const Contact line = press(level, layer, {Shape::kLine, 5.0}, 0.15);
    const auto across = [&](double x) { return 2.0 * line.field->base_pressure_kpa(x); };
    EXPECT_NEAR(simpson(0.0, line.contact_radius_mm, 400, across), 150.0, 0.1);
  }
}

// A disc under a wide flat punch moves uniformly: 20 kPa on K 100 kPa and 2 mm are u = 0.4 mm, ΔC/C = 0.4 / 1.6.
TEST(Taxel, UnderAWidePunchByHand) {
  const Layer layer{2.0, 0.0, 100.0};
  const Contact contact = press(Level::kWinkler, layer, {Shape::kFlatPunch, 10.0}, 0.02 * pi * 100.0);
  EXPECT_NEAR(contact.indentation_mm, 0.4, 1e-12);
  EXPECT_NEAR(taxel_dc_over_c(layer, contact, 0.0), 0.25, 1e-9);
  EXPECT_NEAR(taxel_dc_over_c(layer, contact, 7.9), 0.25, 1e-9);
  EXPECT_NEAR(taxel_dc_over_c(layer, contact, 12.1), 0.0, 1e-12);
  EXPECT_NEAR(taxel_displacement_mm(contact, 3.0), 0.4, 1e-9);
}

// The punch's edge crosses the disc along a diameter, far from the axis: half of the disc is pressed, apart from the
// curvature of the edge. By area: circles of radius 2 at distance 100 from the centre of one of radius 100 share 6.2567
// mm² of 12.566.
TEST(Taxel, AcrossAnEdgeByArea) {
  const Layer layer{2.0, 0.0, 100.0};
  const Contact contact = press(Level::kWinkler, layer, {Shape::kFlatPunch, 100.0}, 0.02 * pi * 10000.0);
  const double alpha = std::acos(1.0 - 4.0 / 20000.0), beta = std::acos(2.0 / 200.0);
  const double lens = 10000.0 * (alpha - std::sin(2.0 * alpha) / 2.0) + 4.0 * (beta - std::sin(2.0 * beta) / 2.0);
  EXPECT_NEAR(taxel_dc_over_c(layer, contact, 100.0), 0.25 * lens / (4.0 * pi), 1e-6);
}

class Range : public testing::TestWithParam<double> {};

// Compares the table with the exact solution between its rows, down to the edge of its range.
TEST_P(Range, TableIsWithinHalfAPercent) {
  const Layer layer{2.0, GetParam(), 100.0};
  const ContactTable table(layer);
  for (const auto& [radius, force] :
       std::vector<std::pair<double, double>>{{3.0, 0.01}, {3.0, 0.15}, {6.0, 0.4}, {12.0, 1.0}, {50.0, 4.0}}) {
    const Indenter sphere{Shape::kSphere, radius};
    const Contact exact = press_bonded(layer, sphere, force), looked_up = table.press(sphere, force);
    const double peak = taxel_dc_over_c(layer, exact, 0.0);
    EXPECT_NEAR(looked_up.indentation_mm / exact.indentation_mm, 1.0, 5e-3) << radius;
    EXPECT_NEAR(looked_up.contact_radius_mm / exact.contact_radius_mm, 1.0, 5e-3) << radius;
    EXPECT_NEAR(looked_up.peak_pressure_kpa / exact.peak_pressure_kpa, 1.0, 5e-3) << radius;
    for (const double r : {0.0, 1.5, 3.3, 5.0, 9.0})
      EXPECT_NEAR(taxel_dc_over_c(layer, looked_up, r), taxel_dc_over_c(layer, exact, r), 5e-3 * peak) << radius;
  }
}

INSTANTIATE_TEST_SUITE_P(Poisson, Range, testing::Values(0.0, 0.3, 0.49));

void expect_refused(Level level, const Layer& layer, const Indenter& indenter, double force, const char* words) {
  try {
    (void)press(level, layer, indenter, force);
    FAIL() << "taken: " << words;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(words));
  }
}

TEST(Refused, ValuesOutOfRangeAreNamed) {
  const Layer layer;
  const Indenter sphere;
  expect_refused(Level::kFft, {0.0, 0.3, 100.0}, sphere, 1.0, "thickness is 0 mm");
  expect_refused(Level::kWinkler, {2.0, 0.5, 100.0}, sphere, 1.0, "Poisson's ratio is 0.5");
  expect_refused(Level::kLogarithmic, {2.0, 0.3, -1.0}, sphere, 1.0, "modulus is -1 kPa");
  expect_refused(Level::kTable, layer, {Shape::kSphere, -2.0}, 1.0, "radius is -2 mm");
  expect_refused(Level::kFft, layer, sphere, 0.0, "force is 0");
  expect_refused(Level::kFft, layer, sphere, std::nan(""), "force is nan");
}

TEST(Refused, ContactThatReachesTheBase) {
  const Layer layer{2.0, 0.3, 100.0};
  for (const Level level : {Level::kWinkler, Level::kLogarithmic, Level::kFft}) {
    expect_refused(level, layer, {Shape::kSphere, 10.0}, 500.0, "reach the base of the layer, which is 2 mm");
    if (level != Level::kLogarithmic) {
      expect_refused(level, layer, {Shape::kFlatPunch, 2.0}, 50.0, "reach the base");
      expect_refused(level, layer, {Shape::kLine, 5.0}, 10.0, "reach the base");
    }
    expect_refused(level, {3.0, 0.3, 100.0}, {Shape::kSphere, 0.5}, 5.0, "equator");
  }
  expect_refused(Level::kFft, {0.01, 0.3, 100.0}, {Shape::kParaboloid, 500.0}, 50.0, "level");
}

// The largest contact of such a sphere, 0.95 of its radius, is below the smallest radius of the table, 0.06 mm.
TEST(Refused, SphereThatIsSmallerThanTheTable) {
  expect_refused(Level::kTable, {2.0, 0.3, 100.0}, {Shape::kSphere, 0.06}, 1e-5, "radius is outside of the table");
  expect_refused(Level::kTable, {2.0, 0.3, 100.0}, {Shape::kSphere, 1e-9}, 1e-5, "radius is outside of the table");
}

}  // namespace
}  // namespace triskin::mechanics
