// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "step_edits.hpp"
#include "triskin/base/address_sanitizer.hpp"
#include "triskin/base/error.hpp"
#include "triskin/cad/part_picture.hpp"
#include "triskin/cad/part_stream.hpp"
#include "triskin/cad/read_part.hpp"
#include "triskin/cad/select_faces.hpp"

namespace triskin::cad {
namespace {

using test::good_part;
using test::with;
using test::with_all;
using test::with_entity;
using ::testing::Contains;
using ::testing::HasSubstr;

double area_cm2(const Part& part) {
  double area = 0.0;
  for (const Face& face : part.faces) area += face.area_mm2 / 100.0;
  return area;
}

// Expects the generated cover, whatever its schema, unit and spelling.
void expect_cover(const Part& part) {
  ASSERT_EQ(part.bodies.size(), 1U);
  EXPECT_TRUE(part.bodies[0].is_solid);
  ASSERT_EQ(part.faces.size(), 6U);
  EXPECT_NEAR(area_cm2(part), 398.717, 0.001);
  EXPECT_TRUE(part.faults.empty());
  EXPECT_LE(part.deviation_mm, 0.05);
  EXPECT_EQ(part.bodies[0].open_edges, 0);
  const design::Vec3 size = size_of(part);
  EXPECT_NEAR(size.x(), 93.892, 0.05);
  EXPECT_NEAR(size.y(), 79.975, 0.05);
  EXPECT_NEAR(size.z(), 140.0, 1e-6);
}

TEST(GeneratedCover, IsReadWithNameAndColour) {
  const Part part = read_part_bytes(good_part(), "cover.step");
  expect_cover(part);
  EXPECT_EQ(part.format, "STEP AP214");
  EXPECT_EQ(part.unit, "millimetre");
  EXPECT_EQ(part.bodies[0].name, "cover");
  FaceSelection by_name, by_colour;
  by_name.names = {"outer"};
  by_colour.colours = {"red"};
  EXPECT_EQ(select_faces(part, by_name), select_faces(part, by_colour));
  const Face& outer = part.faces[static_cast<std::size_t>(select_faces(part, by_name).front())];
  EXPECT_NEAR(outer.area_mm2, 19547.7, 0.1);
  EXPECT_EQ(outer.colour, "#ff0000");
  EXPECT_EQ(outer.entity, "#17");
  EXPECT_EQ(outer.side, FaceSide::kOutward);
}

TEST(GeneratedCover, TheConcaveSheetOfTheWallLooksInward) {
  const Part part = read_part_bytes(good_part(), "cover.step");
  for (const Face& face : part.faces) {
    if (face.kind != SurfaceKind::kCylinder) continue;
    EXPECT_EQ(face.side, face.radius_mm > 79.0 ? FaceSide::kOutward : FaceSide::kInward) << face.radius_mm;
  }
}

TEST(GeneratedCover, OtherUnitsAndSchemas) {
  expect_cover(read_part_bytes(test::part_file("04_inch.step"), "inch.step"));
  expect_cover(read_part_bytes(test::part_file("20_ap203.step"), "ap203.step"));
  EXPECT_EQ(read_part_bytes(test::part_file("04_inch.step"), "inch.step").unit, "inch");
}

TEST(GeneratedCover, LegalSpellings) {
  expect_cover(read_part_bytes(with(good_part(), "#12 = ", "#12\n = "), "breaks.step"));
  expect_cover(read_part_bytes(with_all(good_part(), "\n", "\r\n"), "crlf.step"));
  expect_cover(read_part_bytes("\xEF\xBB\xBF" + good_part(), "bom.step"));
}

TEST(GeneratedCover, NamesComeThroughAsTheyWere) {
  const auto name_of = [](const std::string& written) {
    const Part part =
        read_part_bytes(with(good_part(), "ADVANCED_FACE('outer'", "ADVANCED_FACE('" + written + "'"), "names.step");
    return part.faces.front().name;
  };
  EXPECT_EQ(name_of("Geh\\X\\E4use \\X2\\591658F3\\X0\\ \\X4\\0001F916\\X0\\ \\S\\d it''s a \\\\ path"),
            "Gehäuse 外壳 🤖 ä it's a \\ path");
  EXPECT_EQ(name_of("Geh\xC3\xA4use"), "Gehäuse");
  EXPECT_EQ(name_of("\xCD\xE2\xBF\xC7"), "外壳");
  EXPECT_EQ(name_of("<script>$(touch x)"), "<script>$(touch x)");
}

TEST(GeneratedCover, WithoutAUnit) {
  const std::string bare = with(good_part(), "GLOBAL_UNIT_ASSIGNED_CONTEXT\n((#350,#351,#352))", "");
  const Part part = read_part_bytes(bare, "bare.step");
  expect_cover(part);
  EXPECT_THAT(part.warnings, Contains(HasSubstr("--unit")));
  ReadOptions inches;
  inches.unit_mm = 25.4;
  EXPECT_NEAR(area_cm2(read_part_bytes(bare, "bare.step", inches)), 398.717 * 25.4 * 25.4, 1.0);
}

TEST(GeneratedCover, AsAnOpenSurface) {
  const std::string open = with(
      with(with(with(with(good_part(), "ADVANCED_BREP_SHAPE_REPRESENTATION", "MANIFOLD_SURFACE_SHAPE_REPRESENTATION"),
                     "MANIFOLD_SOLID_BREP('',#16)", "SHELL_BASED_SURFACE_MODEL('',(#16))"),
                "CLOSED_SHELL('',(#17,#139,#216,#265,#315,#342))", "OPEN_SHELL('',(#17))"),
           "#7 = ", "#7 = "),
      "#12 = ", "#12 = ");
  const Part part = read_part_bytes(open, "open.step");
  ASSERT_EQ(part.faces.size(), 1U);
  EXPECT_NEAR(area_cm2(part), 195.477, 0.001);
  EXPECT_EQ(part.bodies[0].free_edges, 4);
  EXPECT_EQ(part.bodies[0].open_edges, 0);
  EXPECT_TRUE(part.faults.empty());
}

TEST(GeneratedCover, AGapAtAVertexLeavesNoHole) {
  const Part part =
      read_part_bytes(with_entity(25, "CARTESIAN_POINT('',(-13.89185421335,78.784620240977,140.05))"), "gap.step");
  EXPECT_TRUE(part.faults.empty());
  EXPECT_NEAR(area_cm2(part), 398.717, 0.1);
  EXPECT_EQ(part.bodies.front().open_edges, 0);
}

std::string refusal_of(const std::string& bytes, const std::string& name = "part.step") {
  try {
    (void)read_part_bytes(bytes, name);
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(PartsWithoutGeometry, AreToldWithTheReason) {
  const auto with_entities = [](const std::string& entities) {
    return good_part().substr(0, good_part().find("DATA;") + 6) + entities + "ENDSEC;\nEND-ISO-10303-21;\n";
  };
  EXPECT_THAT(refusal_of(with_entities("#1=DOCUMENT_FILE('arm.stp','','',$,'',$);\n")), HasSubstr("arm.stp"));
  EXPECT_THAT(refusal_of(with_entities("#1=TRIANGULATED_FACE('',$,3,((0.,0.,1.)),$,(),((1,2,3)));\n")),
              HasSubstr("tessellation"));
  EXPECT_THAT(refusal_of(with_entities("#1=BLOCK('',$,1.,1.,1.);\n")), HasSubstr("CSG"));
  EXPECT_THAT(refusal_of(with_entities("#1=APPLICATION_CONTEXT('x');\n")), HasSubstr("no faces"));
}

TEST(PartStream, DamagedAnswersAreRefused) {
  const std::string bytes = encode_part(read_part_bytes(good_part(), "cover.step"));
  EXPECT_EQ(decode_part(bytes).faces.size(), 6U);
  EXPECT_THROW((void)decode_part(bytes.substr(0, bytes.size() - 1)), InputError);
  EXPECT_THROW((void)decode_part(bytes.substr(0, 4)), InputError);
  std::string wild = bytes;
  wild[wild.size() - 1] = '\x7f';  // This byte belongs to the face of the last triangle.
  EXPECT_THROW((void)decode_part(wild), InputError);
}

TEST(ReaderProcess, LimitsEndIt) {
  if (kAddressSanitizer) GTEST_SKIP() << "the address sanitizer cannot live with a limit of addresses";
  ReadOptions tight;
  tight.memory_mb = 40;
  EXPECT_THROW((void)read_part_bytes(good_part(), "part.step", tight), InputError);
  EXPECT_EQ(read_part_bytes(good_part(), "part.step").faces.size(), 6U);
}

TEST(PartPicture, EscapesNames) {
  Part part = read_part_bytes(good_part(), "cover.step");
  part.bodies[0].name = "<script>alert(1)</script>";
  const std::string svg = part_svg(part);
  EXPECT_EQ(svg.find("<script"), std::string::npos);
  EXPECT_THAT(svg, HasSubstr("&lt;script&gt;"));
}

}  // namespace
}  // namespace triskin::cad
