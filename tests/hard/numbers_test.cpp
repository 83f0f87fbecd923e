// SPDX-License-Identifier: GPL-3.0-or-later
// Cases at the edge of the numbers that belong to no part's own tests; each answer is worked by hand.
// tests/hard/cases.txt lists these and those of the parts.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "support/temp_folder.hpp"
#include "triskin/base/error.hpp"
#include "triskin/fabrication/nesting.hpp"
#include "triskin/geometry/segment.hpp"
#include "triskin/geometry/triangle.hpp"
#include "triskin/logic/sampling/compensation.hpp"
#include "triskin/mechanics/contact_table.hpp"
#include "triskin/mechanics/inverse.hpp"
#include "triskin/mechanics/pressure_contacts.hpp"
#include "triskin/mesh/decimated_mesh.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/placement/placement.hpp"
#include "triskin/placement/polygon_io.hpp"
#include "triskin/routing/routing.hpp"
#include "triskin/session/clock_filter.hpp"
#include "triskin/skin/calibrate.hpp"
#include "triskin/unfolding/unfolding.hpp"

namespace triskin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The square of 1e150 is still a number; the point above the middle is 3 away.
TEST(HardGeometry, segments_from_subnormal_to_1e150) {
  const double least = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(geometry::distance_to_segment(Vector2d(0, 3), Vector2d(0, 0), Vector2d(least, 0)), 3.0);
  EXPECT_EQ(geometry::distance_to_segment(Vector2d(0, 3), Vector2d(-1e-160, 0), Vector2d(1e-160, 0)), 3.0);
  EXPECT_EQ(geometry::distance_to_segment(Vector2d(0, 3), Vector2d(-1e150, 0), Vector2d(1e150, 0)), 3.0);
  EXPECT_EQ(geometry::distance_to_segment(Vector3d(0, 3, 0), Vector3d(-1e150, 0, 0), Vector3d(1e150, 0, 0)), 3.0);
}

// A triangle whose area is no number any more is the point at its corner.
TEST(HardGeometry, triangle_with_an_area_below_the_least_number) {
  const geometry::Triangle t{Vector3d(0, 0, 0), Vector3d(1e-200, 0, 0), Vector3d(0, 1e-200, 0)};
  EXPECT_EQ(geometry::distance_to_triangle(Vector3d(0, 0, 3), t), 3.0);
  EXPECT_EQ(geometry::distance_to_triangle(Vector3d(3, 4, 0), t), 5.0);
}

placement::PlacementResult placed(const std::string& outline) {
  placement::PlacementOptions options;
  options.time_limit_s = 0.0;  // No limit.
  options.threads = 1;
  return placement::place(placement::parse_polygon(outline, "outline"), options);
}

// A subnormal coordinate is 0 for a length of 60 mm: the triangle of side 60.000001 holds 4 modules.
TEST(HardPlacement, subnormal_coordinates_of_a_file) {
  const placement::PlacementResult r =
      placed("POLYGON((4.9e-324 0, 60.000001 1e-310, 30 51.96152507, 0 0, 4.9e-324 0))");
  EXPECT_EQ(r.modules, 4);
  EXPECT_TRUE(r.proved);
}

TEST(HardPlacement, numbers_that_doubles_do_not_have_are_refused) {
  EXPECT_INPUT_ERROR((void)placed("POLYGON((0 0, 1e400 0, 0 60, 0 0))"), "number");
  EXPECT_INPUT_ERROR((void)placed("POLYGON((0 0, nan 0, 0 60, 0 0))"), "(nan, 0)");
  // Products of such coordinates are none.
  EXPECT_INPUT_ERROR((void)placed("POLYGON((0 0, 1e200 0, 0 1e200, 0 0))"), "outline");
}

// A strip of 1 m × 1e-9 mm is lower than a module by any measure.
TEST(HardPlacement, a_strip_of_1e_9_mm_holds_nothing) {
  const placement::PlacementResult r = placed("POLYGON((0 0, 1000 0, 1000 1e-9, 0 1e-9, 0 0))");
  EXPECT_EQ(r.modules, 0);
  EXPECT_EQ(r.upper_bound, 0);
}

design::ModuleGraph chain(int modules, bool is_ring) {
  design::ModuleGraph g;
  g.nodes.resize(static_cast<std::size_t>(modules));
  const auto join = [&](int a, int b) {
    auto &one = g.nodes[static_cast<std::size_t>(a)], &other = g.nodes[static_cast<std::size_t>(b)];
    one.neighbour[0] = b;
    one.border[0] = false;
    other.neighbour[1] = a;
    other.border[1] = false;
  };
  for (int k = 0; k + 1 < modules; ++k) join(k, k + 1);
  if (is_ring) join(modules - 1, 0);
  return g;
}

// A controller serves 16: sixteen in a row or a ring need one, seventeen need two, one needs one.
TEST(HardRouting, at_the_capacity_of_a_controller) {
  for (const auto& [modules, is_ring, controllers] : {std::tuple(1, false, 1),
                                                      {16, false, 1},
                                                      {17, false, 2},
                                                      {16, true, 1},
                                                      {17, true, 2},
                                                      {32, true, 2},
                                                      {33, true, 3}}) {
    const routing::RoutingResult r = routing::route(chain(modules, is_ring));
    EXPECT_EQ(r.patches.size(), static_cast<std::size_t>(controllers))
        << modules << (is_ring ? " in a ring" : " in a row");
    EXPECT_EQ(r.lower_bound, controllers);
    EXPECT_TRUE(r.proved);
  }
}

design::Mesh grid(int cells, double width, double height, const Vector3d& at) {
  design::Mesh m;
  for (int v = 0; v <= cells; ++v) {
    for (int u = 0; u <= cells; ++u) m.vertices.push_back(at + Vector3d(width * u / cells, height * v / cells, 0));
  }
  for (int v = 0; v < cells; ++v) {
    for (int u = 0; u < cells; ++u) {
      const int a = v * (cells + 1) + u, b = a + cells + 1;
      m.faces.push_back({a, a + 1, b + 1});
      m.faces.push_back({a, b + 1, b});
    }
  }
  return m;
}

// Two faces folded by 2 rad, far beyond what a joint may fold, are two halves of a rhombus; at 1e6 mm too.
TEST(HardUnfolding, two_faces_folded_by_2_rad_are_one_piece) {
  for (const Vector3d& at : {Vector3d(0, 0, 0), Vector3d(1e6, -1e6, 1e6)}) {
    design::Mesh m;
    for (const Vector3d& v : {Vector3d(0, 0, 0), Vector3d(60, 0, 0), Vector3d(30, 50, 0),
                              Vector3d(30, -50.0 * std::cos(2.0), 50.0 * std::sin(2.0))})
      m.vertices.push_back(at + v);
    m.faces.push_back({0, 1, 2});
    m.faces.push_back({1, 0, 3});
    const unfolding::Net net = unfolding::unfold(mesh::Surface(m), {.edge_error_mm = 1e-6});
    EXPECT_EQ(net.pieces.size(), 1U);
    EXPECT_EQ(net.overlaps, 0);
  }
}

// A plate in strips of 1 µm by 100 mm is flat: one piece, nothing stretched.
TEST(HardUnfolding, needles_of_1_to_100000_stay_flat) {
  const unfolding::Net net = unfolding::unfold(mesh::Surface(grid(4, 0.004, 400, {0, 0, 0})), {.edge_error_mm = 1e-6});
  EXPECT_EQ(net.pieces.size(), 1U);
  EXPECT_EQ(net.overlaps, 0);
}

// At 1e6 mm doubles are 1.2e-10 mm apart: a divided plate becomes two faces there as at the origin, and at 1e-9 rad.
TEST(HardMesh, a_plate_far_away_or_turned_by_a_hair_becomes_two_faces) {
  for (const Vector3d& at : {Vector3d(0, 0, 0), Vector3d(1e6, -1e6, 1e6)}) {
    for (const double angle : {0.0, 1e-9, 0.7}) {
      design::Mesh m = grid(8, 100, 100, at);
      for (auto& v : m.vertices) v = Eigen::AngleAxisd(angle, Vector3d(1, 2, 3).normalized()) * v;
      const mesh::DecimatedMesh made = mesh::decimate(mesh::Surface(m), 1e-6, 1e-6, 1);
      EXPECT_EQ(made.mesh.faces.size(), 2U) << "at " << at.x() << ", " << angle << " rad";
      EXPECT_LE(made.deviation_mm, 1e-6);
    }
  }
}

fabrication::FlatIsland rectangle(double width_mm, double height_mm) {
  fabrication::FlatIsland island;
  island.part_number = "R";
  island.outline_mm = {{0, 0}, {width_mm, 0}, {width_mm, height_mm}, {0, height_mm}};
  return island;
}

// With gaps of 1 mm a sheet of 300 × 400 mm takes 298 × 398 mm exactly, and 0.01 mm more not.
TEST(HardNesting, an_island_as_large_as_the_sheet_allows) {
  const fabrication::Nesting full = fabrication::nest({rectangle(298, 398)}, {.tries = 1});
  ASSERT_EQ(full.used_mm.size(), 1U);
  EXPECT_NEAR(full.used_mm[0], 400.0, 1e-6);  // The gap is kept by distances of double precision.
  EXPECT_THROW((void)fabrication::nest({rectangle(298.01, 398)}, {.tries = 1}), InputError);
}

// An answer that came at once leaves no doubt but that of stamps in whole microseconds, also at 2^62 µs: doubles have
// steps of 1,024 µs there.
TEST(HardClock, an_answer_without_delay_and_stamps_of_2_to_62) {
  constexpr std::uint64_t kLate = std::uint64_t{1} << 62U;
  for (const std::uint64_t sent_us : {std::uint64_t{1'000'000}, std::uint64_t{1'795'912'463'436'872}, kLate}) {
    session::ClockFilter filter;
    filter.exchanged(sent_us, sent_us + 4'000'000, sent_us);
    for (const std::uint64_t later_us : {0U, 1'000U}) {
      const session::LinkTime t = filter.at(sent_us + 4'000'000 + later_us);
      EXPECT_LE(t.error_us, 3U) << sent_us;
      EXPECT_LE(t.link_us > sent_us + later_us ? t.link_us - sent_us - later_us : sent_us + later_us - t.link_us,
                t.error_us)
          << sent_us;
    }
  }
}

// The slope is −10 counts a kPa exactly, however far the rest value is; at 1e9 a double has steps of 1.2e-7.
TEST(HardCalibration, rest_values_of_1e9_and_pressures_that_are_hardly_different) {
  const std::vector<skin::CalibrationPoint> far{{0, 1e9, 1}, {1, 1e9 - 10, 1}, {2, 1e9 - 20, 1}};
  const auto line = skin::fit_sensitivity(far);
  ASSERT_TRUE(line);
  EXPECT_NEAR(line->sensitivity.counts_per_kpa, 10.0, 1e-6);
  const std::vector<skin::CalibrationPoint> equal{{5, 100, 1}, {5, 90, 1}, {5, 80, 1}};
  EXPECT_FALSE(skin::fit_sensitivity(equal));
  // The squares of such differences are no numbers; whatever is said of them must be one.
  const std::vector<skin::CalibrationPoint> subnormal{{0, 100, 1}, {4.9e-324, 90, 1}, {1e-323, 80, 1}};
  if (const auto none = skin::fit_sensitivity(subnormal)) {
    EXPECT_TRUE(std::isfinite(none->sensitivity.counts_per_kpa));
    EXPECT_TRUE(std::isfinite(none->sensitivity.error_percent));
  }
}

// Raw values at both ends, gains of both signs at their ends: 0x8000 + change − gain · change of the pads, limited.
TEST(HardCompensation, both_ends_of_counts_and_gains) {
  for (const int gain : {-32768, 32767}) {
    fw::Compensation c;
    for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) c.set_gain(t, static_cast<std::int16_t>(gain));
    fw::Compensation::Taxels low{}, high{};
    high.fill(65535);
    c.add(low, layout::kAllTaxels);
    EXPECT_EQ(c.output()[0], 0x8000);
    c.add(high, layout::kAllTaxels);
    // Change 65535 less gain · 65535: with −2 far above the range; with 2 − 2⁻¹⁴ it is −65531, far below.
    EXPECT_EQ(c.output()[0], gain < 0 ? 65535 : 0);
    c.add(low, layout::kAllTaxels);
    EXPECT_EQ(c.output()[0], 0x8000);
  }
}

std::vector<Vector2d> taxels(int columns, int rows) {
  std::vector<Vector2d> all;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) all.emplace_back(6.5 * i + 3.25 * (j % 2), 5.63 * j);
  }
  return all;
}

std::vector<mechanics::TaxelObservation> observed(const std::vector<Vector2d>& at, const std::vector<double>& values) {
  std::vector<mechanics::TaxelObservation> seen;
  for (std::size_t t = 0; t < at.size(); ++t) seen.push_back({at[t], values[t]});
  return seen;
}

// Two equal tips at one place are one contact there, and none says more certainty than it has: the forces add up.
TEST(HardContacts, two_at_one_place_are_one_with_their_force) {
  const mechanics::ContactTable table(mechanics::Layer{2.0, 0.3, 30.0});
  const std::vector<Vector2d> at = taxels(9, 8);
  mechanics::ContactEstimate tip;
  tip.position_mm = {26.0, 20.0};
  tip.force_n = 0.25;
  tip.tip_radius_mm = 15.0;
  const std::vector<mechanics::ContactEstimate> both{tip, tip};
  const auto found = mechanics::find_contacts(table, observed(at, mechanics::predict_taxels(table, at, both)),
                                              {.noise_dc_over_c = 0.01});
  ASSERT_EQ(found.contacts.size(), 1U);
  const mechanics::ContactEstimate& c = found.contacts[0];
  EXPECT_LT((c.position_mm - tip.position_mm).norm(), 1.96 * c.position_sd_mm.norm());
  EXPECT_LT(std::abs(c.force_n - 0.5), 1.96 * c.force_sd_n);
}

// A tip on the last row: half of what it does is seen by nobody, and the stated deviations cover the truth.
TEST(HardContacts, at_the_border_of_the_skin_the_deviations_cover_the_truth) {
  const mechanics::ContactTable table(mechanics::Layer{2.0, 0.3, 30.0});
  const std::vector<Vector2d> at = taxels(9, 8);
  for (const Vector2d& place : {Vector2d(0.0, 0.0), Vector2d(26.0, 0.0), Vector2d(52.0, 39.4), Vector2d(26.0, -2.0)}) {
    mechanics::ContactEstimate tip;
    tip.position_mm = place;
    tip.force_n = 0.5;
    tip.tip_radius_mm = 15.0;
    const auto found = mechanics::find_contacts(
        table, observed(at, mechanics::predict_taxels(table, at, std::vector{tip})), {.noise_dc_over_c = 0.01});
    ASSERT_EQ(found.contacts.size(), 1U) << place.transpose();
    const mechanics::ContactEstimate& c = found.contacts[0];
    EXPECT_LT((c.position_mm - place).norm(), 2.45 * c.position_sd_mm.norm()) << place.transpose();
    EXPECT_LT(std::abs(c.force_n - 0.5), 1.96 * c.force_sd_n) << place.transpose();
  }
}

}  // namespace
}  // namespace triskin
