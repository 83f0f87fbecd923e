// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of a repair give up in turn: a simulated clock jumps past the end when a part begins. The result must be a
// surface that design() accepts, still within the stated deviation.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "plan/mesh/broken_meshes.hpp"
#include "plan/mesh/distances.hpp"
#include "triskin/mesh/extract.hpp"

namespace triskin {
namespace {

using design::Mesh;
using design::Vec3;
using mesh::Extraction;
using mesh::ExtractOptions;
using mesh::Repair;

// Counts the seconds of a clock that stands still until a stage begins, and how often it is read after that.
struct JumpingClock {
  std::string stage;
  double now_s = 0.0;
  int asked_late = 0;

  void see(const std::string& started) {
    if (started == stage) now_s = 1e6;
  }
  double ask() {
    asked_late += now_s > 0.0 ? 1 : 0;
    return now_s;
  }
};

struct Outcome {
  Extraction extraction;
  int asked_late = 0;
};

// `stage` is the progress name of the part at whose beginning the time is over; empty means never.
Outcome repaired(const Mesh& mesh, const std::string& stage, double repair_s) {
  JumpingClock clock{stage};
  ExtractOptions options;
  options.repair = options.keep_usable = true;
  options.repair_s = repair_s;
  options.wrap_alpha_mm = 12.0;  // This share is a quarter of the time.
  options.outer = options.wrap = ExtractOptions::When::kWhenNeeded;
  options.clock_s = [&clock] { return clock.ask(); };
  Extraction e = mesh::extract(mesh, options, [&clock](const Progress& p) { clock.see(p.stage); });
  return {std::move(e), clock.asked_late};
}

// Checks a late result: it is valid, and both ends of the interval hold.
void expect_honest(const Outcome& run, const Mesh& input) {
  EXPECT_TRUE(mesh::usable(run.extraction.surface));
  const auto& d = run.extraction.report.deviation;
  test::Dice dice(7);
  const double away_mm = test::sampled_distance(run.extraction.surface, input, dice, 300);
  EXPECT_LE(away_mm, d.largest_mm + 1e-6);  // distance_to() of the test has no more digits.
  EXPECT_LE(d.found_mm, d.largest_mm);
  EXPECT_GT(run.asked_late, 0);
  EXPECT_LT(run.asked_late, 30);  // Each part asks once or twice, and a child process is ended at once.
}

// Makes two balls of 2,400 faces that cross along a circle.
Mesh crossed_balls() {
  Mesh mesh = test::read_back(test::grid_of(test::base_shapes()[0].place, 40, 31));
  test::Dice dice(3);
  test::damage::crossed(mesh, dice);
  return mesh;
}

// Makes a ball of 2,400 faces of which no two are joined, so no part is as large as a module.
Mesh shattered_ball() {
  Mesh mesh = test::grid_of(test::base_shapes()[0].place, 40, 31);
  test::Dice dice(3);
  test::damage::gaps(mesh, dice);
  return test::read_back(mesh);
}

double interval_mm(const Outcome& run) {
  const auto& d = run.extraction.report.deviation;
  return d.largest_mm - d.found_mm;
}

constexpr double kPlenty_s = 40.0, kLittle_s = 1.0;

// Returns a clock that stands still for some questions and is far past any end from then on.
std::function<double()> ends_after(int questions) {
  return [left = questions]() mutable { return left-- > 0 ? 0.0 : 1e6; };
}

Extraction tested(const Mesh& mesh, const std::function<double()>& clock_s) {
  ExtractOptions options;
  options.repair_s = 2.0;
  options.repair = options.keep_usable = true;
  options.outer = options.wrap = ExtractOptions::When::kWhenNeeded;
  options.clock_s = clock_s;
  return mesh::extract(mesh, options);
}

// A sheet of 320,000 faces is tested in parts of some 100,000.
TEST(RepairTime, test_whether_one_is_needed_gives_up_and_says_so) {
  const Mesh sheet = test::grid_of([](double u, double v) { return Vec3(300 * u, 300 * v, 10 * u * v); }, 400, 400);
  const Extraction whole = tested(sheet, ends_after(1000)), part = tested(sheet, ends_after(3));
  EXPECT_EQ(whole.report.tested, 1.0);
  EXPECT_GT(part.report.tested, 0.1);
  EXPECT_LT(part.report.tested, 0.9);
  EXPECT_EQ(part.report.repair, Repair::kNone);
  EXPECT_EQ(part.surface.faces.size(), sheet.faces.size());
}

// In addition, a strip crosses the sheet near the end that a tree of the faces visits last; 800 of its faces cross.
TEST(RepairTime, part_of_the_test_finds_a_crossing_that_is_long) {
  Mesh sheet = test::grid_of([](double u, double v) { return Vec3(300 * u, 300 * v, 10 * u * v); }, 400, 400);
  test::append(sheet, test::grid_of([](double u, double v) { return Vec3(280.2, 300 * u, 60 * v - 30); }, 40, 3));
  EXPECT_NE(tested(sheet, ends_after(3)).report.repair, Repair::kNone);
}

// Two balls of 14,400 faces each cross, but 1 s of repair allows for 20,000. They are reduced first, which the report
// states: chords twice as long lie 0.1 mm below a ball of 75 mm, and the bounds of the steps between add up.
TEST(RepairTime, mesh_with_more_faces_than_it_is_worth_is_reduced_first) {
  Mesh mesh = test::read_back(test::grid_of(test::base_shapes()[0].place, 120, 61));
  test::Dice dice(3);
  test::damage::crossed(mesh, dice);
  const Extraction e = repaired(mesh, "", 1.0).extraction;
  EXPECT_EQ(e.report.repair, Repair::kLocal);
  EXPECT_LT(e.surface.faces.size(), 21'000U);  // Some faces are divided.
  EXPECT_GT(e.report.reduced_mm, 0.01);
  EXPECT_LT(e.report.reduced_mm, 0.3);
  EXPECT_GE(e.report.deviation.largest_mm, e.report.reduced_mm);
  EXPECT_TRUE(mesh::usable(e.surface));
  EXPECT_LE(test::sampled_distance(e.surface, mesh, dice, 60), e.report.deviation.largest_mm + 1e-6);
}

TEST(RepairTime, dividing_gives_up_and_what_crosses_goes) {
  const Mesh mesh = crossed_balls();
  const Outcome whole = repaired(mesh, "", kPlenty_s), late = repaired(mesh, "dividing faces that cross", kPlenty_s);
  expect_honest(late, mesh);
  EXPECT_EQ(late.extraction.report.repair, Repair::kLocal);
  EXPECT_EQ(whole.extraction.report.repair, Repair::kLocal);
  EXPECT_EQ(whole.extraction.report.reduced_mm, 0.0);
  EXPECT_LT(whole.extraction.report.deviation.largest_mm, 0.1);  // Divided along the circle, nothing is missing.
  EXPECT_GT(late.extraction.report.deviation.largest_mm, 1.0);
  // Welding moves vertices by 1e-6 of 260 mm; the few faces are measured quickly.
  EXPECT_LE(interval_mm(late), 0.02 + 1e-3);
}

TEST(RepairTime, settling_gives_up_without_a_look_at_the_sky) {
  Mesh mesh = test::read_back(test::grid_of(test::base_shapes()[0].place, 40, 31));
  test::Dice dice(5);
  test::damage::noise(mesh, dice);
  const Outcome whole = repaired(mesh, "", kPlenty_s), late = repaired(mesh, "settling the repair", kPlenty_s);
  expect_honest(late, mesh);
  // The other face of some pairs was dropped.
  EXPECT_NE(late.extraction.surface.faces.size(), whole.extraction.surface.faces.size());
}

TEST(RepairTime, wrapping_gives_up_and_a_grid_follows) {
  const Mesh mesh = shattered_ball();
  EXPECT_EQ(repaired(mesh, "", kPlenty_s).extraction.report.repair, Repair::kWrap);
  const Outcome late = repaired(mesh, "wrapping", kPlenty_s);
  expect_honest(late, mesh);
  EXPECT_EQ(late.extraction.report.repair, Repair::kGrid);
}

TEST(RepairTime, grid_stays_where_it_is_and_is_measured) {
  const Mesh mesh = shattered_ball();
  const Outcome whole = repaired(mesh, "", kLittle_s), late = repaired(mesh, "wrapping on a grid", kLittle_s);
  expect_honest(late, mesh);
  EXPECT_EQ(whole.extraction.report.repair, Repair::kGrid);
  EXPECT_EQ(late.extraction.report.repair, Repair::kGrid);
  EXPECT_LT(whole.extraction.report.deviation.mean_mm, 0.5 * late.extraction.report.deviation.mean_mm);
}

TEST(RepairTime, measure_of_the_deviation_says_its_interval) {
  const Mesh mesh = shattered_ball();
  const Outcome whole = repaired(mesh, "", kPlenty_s), late = repaired(mesh, "measuring the repair", kPlenty_s);
  expect_honest(late, mesh);
  EXPECT_GT(interval_mm(late), interval_mm(whole));
  EXPECT_LE(late.extraction.report.deviation.found_mm, whole.extraction.report.deviation.largest_mm);
  EXPECT_GE(late.extraction.report.deviation.largest_mm, whole.extraction.report.deviation.found_mm);
}

}  // namespace
}  // namespace triskin
