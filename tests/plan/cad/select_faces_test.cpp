// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/cad/select_faces.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "triskin/base/error.hpp"

namespace triskin::cad {
namespace {

using design::BrepFaceIndex;
using ::testing::ElementsAre;

// Makes four squares of 10 mm in a row: the second continues flat, the third bends by 10°, the fourth by 90°.
Part strip() {
  Part part;
  part.bodies = {{"left", "arm/left"}, {"right", "arm/right"}};
  const std::array<double, 4> slope_deg{0.0, 0.0, 10.0, 90.0};
  design::Vec3 at(0, 0, 0);
  for (int f = 0; f < 4; ++f) {
    const double angle = slope_deg[static_cast<std::size_t>(f)] * 3.14159265358979 / 180.0;
    if (f == 0) part.mesh.vertices = {at, at + design::Vec3(0, 10, 0)};
    at += 10.0 * design::Vec3(std::cos(angle), 0, std::sin(angle));
    part.mesh.vertices.push_back(at);
    part.mesh.vertices.push_back(at + design::Vec3(0, 10, 0));
    const int n = 2 * f;
    part.mesh.faces.push_back({n, n + 2, n + 3});
    part.mesh.faces.push_back({n, n + 3, n + 1});
    part.face_of_triangle.insert(part.face_of_triangle.end(), 2, BrepFaceIndex(f));
    Face face;
    face.body = f / 2;
    face.area_mm2 = 100.0 * (f + 1);
    face.kind = f < 2 ? SurfaceKind::kPlane : SurfaceKind::kCylinder;
    face.name = f == 1 ? "middle" : "";
    face.colour = f == 3 ? "#fe0202" : "#00ff00";
    face.hole_diameter_mm = f == 3 ? 4.0 : 0.0;
    face.side = f == 0 ? FaceSide::kInward : FaceSide::kOutward;
    part.faces.push_back(face);
  }
  return part;
}

TEST(SelectFaces, OneOptionEach) {
  const Part part = strip();
  EXPECT_THAT(select_faces(part, {}), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(select_faces(part, {.indices = {BrepFaceIndex{2}, BrepFaceIndex{0}}}), ElementsAre(0, 2));
  EXPECT_THAT(select_faces(part, {.names = {"middle"}}), ElementsAre(1));
  EXPECT_THAT(select_faces(part, {.colours = {"red"}}), ElementsAre(3));
  EXPECT_THAT(select_faces(part, {.kinds = {SurfaceKind::kCylinder}}), ElementsAre(2, 3));
  EXPECT_THAT(select_faces(part, {.bodies = {"right"}}), ElementsAre(2, 3));
  EXPECT_THAT(select_faces(part, {.bodies = {"arm/left"}}), ElementsAre(0, 1));
  EXPECT_THAT(select_faces(part, {.bodies = {"1"}}), ElementsAre(2, 3));
  EXPECT_THAT(select_faces(part, {.min_area_cm2 = 2.0, .max_area_cm2 = 3.0}), ElementsAre(1, 2));
  EXPECT_THAT(select_faces(part, {.only_outward = true}), ElementsAre(1, 2, 3));
  EXPECT_THAT(select_faces(part, {.without_holes_mm = 5.0}), ElementsAre(0, 1, 2));
  EXPECT_THAT(select_faces(part, {.without_holes_mm = 3.0}), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(select_faces(part, {.without_bodies = {"left"}}), ElementsAre(2, 3));
}

TEST(SelectFaces, ARegionGrowsOverSmoothEdges) {
  const Part part = strip();
  FaceSelection from;
  from.from_point_mm = design::Vec3(2, 5, 3);
  EXPECT_THAT(select_faces(part, from), ElementsAre(0, 1, 2));
  from.smooth_deg = 5.0;
  EXPECT_THAT(select_faces(part, from), ElementsAre(0, 1));
  from.smooth_deg = 85.0;
  EXPECT_THAT(select_faces(part, from), ElementsAre(0, 1, 2, 3));
}

TEST(SelectFaces, OptionsNarrowEachOther) {
  EXPECT_THAT(select_faces(strip(), {.kinds = {SurfaceKind::kCylinder}, .without_holes_mm = 5.0}), ElementsAre(2));
}

TEST(SelectFaces, TheSelectionIsKeptAsText) {
  const FaceSelection all{.indices = {BrepFaceIndex{1}, BrepFaceIndex{2}},
                          .names = {"middle"},
                          .colours = {"red"},
                          .kinds = {SurfaceKind::kCone},
                          .bodies = {"left"},
                          .min_area_cm2 = 1.5,
                          .max_area_cm2 = 9.0,
                          .from_point_mm = design::Vec3(1, 2, 3),
                          .smooth_deg = 12.0,
                          .only_outward = true,
                          .without_holes_mm = 3.0,
                          .without_bodies = {"right"}};
  const FaceSelection read = parse_selection(selection_text(all));
  EXPECT_EQ(selection_text(read), selection_text(all));
  EXPECT_EQ(read.kinds, all.kinds);
  EXPECT_EQ(read.from_point_mm, all.from_point_mm);
  EXPECT_EQ(selection_text({}), "{}");
  EXPECT_THROW((void)parse_selection("{\"kinds\":[\"ball\"]}"), InputError);
  EXPECT_THROW((void)parse_selection("{"), InputError);
}

TEST(SelectFaces, WhatIsNotThereIsNamed) {
  const Part part = strip();
  for (const FaceSelection& wrong :
       {FaceSelection{.indices = {BrepFaceIndex{4}}}, FaceSelection{.names = {"outer"}},
        FaceSelection{.colours = {"blue"}}, FaceSelection{.colours = {"mauve"}}, FaceSelection{.bodies = {"arm"}},
        FaceSelection{.names = {"middle"}, .bodies = {"right"}}})
    EXPECT_THROW((void)select_faces(part, wrong), InputError);
}

TEST(SelectFaces, TheirMeshHasNoOtherVertices) {
  const design::Mesh mesh = mesh_of_faces(strip(), {BrepFaceIndex{1}});
  EXPECT_EQ(mesh.faces.size(), 2U);
  EXPECT_EQ(mesh.vertices.size(), 4U);
}

}  // namespace
}  // namespace triskin::cad
