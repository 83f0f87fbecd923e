// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the steps of extract beyond repair: the outside of nested shells, keep-outs, shrink-wrap.
#include "triskin/mesh/extract.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "solids.hpp"
#include "triskin/base/error.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::mesh {
namespace {

using test::both, test::cube, test::inside_out, test::square;
using When = ExtractOptions::When;

double area(const Mesh& m) {
  return Surface(m).area_mm2();
}

double min_distance(const Mesh& m, const Vec3& p) {
  return Surface(m).closest(p).distance_mm;
}

TEST(Extract, HiddenShellGoesAndTheOuterOneIsTurnedOutward) {
  const Mesh raw = both(inside_out(cube(Vec3::Zero(), 100.0)), cube(Vec3::Zero(), 60.0));
  ExtractOptions o;
  o.outer = When::kWhenNeeded;
  const Extraction e = extract(raw, o);
  EXPECT_TRUE(e.report.outer);
  EXPECT_NEAR(area(e.surface), 6.0 * 100.0 * 100.0, 1.0);
  const Surface s(e.surface);
  for (FaceIndex f{0}; f < static_cast<int>(e.surface.faces.size()); ++f) {
    const Vec3& corner = e.surface.vertices[static_cast<std::size_t>(e.surface.faces[static_cast<std::size_t>(f)][0])];
    EXPECT_GT(s.face_normal(f).dot(corner), 0.0);
  }
}

TEST(Extract, CleanSurfaceStaysAsItIs) {
  const Mesh raw = square(100.0, 5);
  ExtractOptions o;
  o.outer = o.wrap = When::kWhenNeeded;
  const Extraction e = extract(raw, o);
  EXPECT_FALSE(e.report.outer);
  EXPECT_FALSE(e.report.wrapped);
  EXPECT_EQ(e.surface.faces.size(), raw.faces.size());
}

TEST(Extract, KeepOutSphereLeavesNothingInsideAndLittleMore) {
  ExtractOptions o;
  const Vec3 middle(43.0, 57.0, 3.0);
  o.spheres.push_back({middle, 12.0});
  const Extraction e = extract(square(100.0, 5), o);
  const double r = std::sqrt(12.0 * 12.0 - 3.0 * 3.0);  // The sphere cuts a circle of this radius out of the plane.
  EXPECT_GE(min_distance(e.surface, middle), 12.0);
  EXPECT_GE(e.report.kept_out_mm2, M_PI * r * r);
  EXPECT_LE(e.report.kept_out_mm2, M_PI * (r + 3.0) * (r + 3.0));
  EXPECT_NEAR(area(e.surface) + e.report.kept_out_mm2, 100.0 * 100.0, 1e-6);
  EXPECT_EQ(e.report.boundary_loops, 2);
}

TEST(Extract, KeepOutBoxAndMeshAgree) {
  ExtractOptions box, mesh;
  box.boxes.push_back({Vec3(30, 30, -10), Vec3(60, 60, 20)});
  mesh.keep_out = cube(Vec3(45, 45, 5), 30.0);
  const double by_box = extract(square(100.0, 5), box).report.kept_out_mm2,
               by_mesh = extract(square(100.0, 5), mesh).report.kept_out_mm2;
  EXPECT_GE(by_box, 900.0);
  EXPECT_LE(by_box, 36.0 * 36.0);
  EXPECT_NEAR(by_mesh, by_box, 1.5 * 1.5);  // A face that just touches may be kept or dropped.
  mesh.keep_out_margin_mm = 5.0;
  EXPECT_GE(extract(square(100.0, 5), mesh).report.kept_out_mm2, 30.0 * 30.0 + 4 * 30.0 * 5.0 + M_PI * 25.0);
}

TEST(Extract, KeepOutThatTakesEverythingIsNamed) {
  ExtractOptions o;
  o.spheres.push_back({Vec3(50, 50, 0), 200.0});
  try {
    (void)extract(square(100.0, 5), o);
    FAIL() << "nothing is left, and no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("keep-out"), std::string::npos) << error.what();
  }
}

TEST(Extract, WrapClosesTwoCubesThatCross) {
  ExtractOptions o;
  o.wrap = When::kWhenNeeded;
  const Extraction e = extract(both(cube(Vec3::Zero(), 60.0), cube(Vec3(30, 10, 5), 60.0)), o);
  EXPECT_TRUE(e.report.wrapped);
  EXPECT_EQ(e.report.boundary_loops, 0);
  EXPECT_EQ(e.report.components, 1);
  EXPECT_NO_THROW(require_no_self_intersection(e.surface, "wrap"));
  // The crossing hides a block of 30 × 50 × 55 mm on both: 2 · 6 · 60² − 2 (30·50 + 50·55 + 55·30) remains.
  EXPECT_NEAR(area(e.surface), 43200.0 - 11800.0, 0.04 * 31400.0);
}

}  // namespace
}  // namespace triskin::mesh
