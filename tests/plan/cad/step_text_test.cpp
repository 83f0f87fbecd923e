// SPDX-License-Identifier: GPL-3.0-or-later
#include "plan/cad/src/step_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "step_edits.hpp"
#include "triskin/base/error.hpp"

namespace triskin::cad {
namespace {

using test::good_part;
using test::with;
using test::with_all;
using test::with_entity;
using ::testing::HasSubstr;

std::string refusal_of(const std::string& bytes) {
  try {
    (void)read_step_text(bytes);
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(StepText, GoodPart) {
  const StepText step = read_step_text(good_part());
  EXPECT_EQ(step.schema, "AP214");
  EXPECT_EQ(step.faces, 6);
  EXPECT_TRUE(step.has_length_unit);
  EXPECT_TRUE(step.warnings.empty());
}

TEST(StepText, SaysWhereAFileIsDamaged) {
  EXPECT_EQ(refusal_of(""), "the file is empty");
  EXPECT_THAT(refusal_of("solid cover\nfacet normal 0 0 1\n"), HasSubstr("looks like an STL"));
  EXPECT_THAT(refusal_of("\x1f\x8b\x08"), HasSubstr("gzip"));
  EXPECT_THAT(refusal_of("<!DOCTYPE html><html>"), HasSubstr("web page"));
  EXPECT_THAT(refusal_of(good_part().substr(0, good_part().find("#196 =") + 12)), HasSubstr("ends within #196"));
  EXPECT_THAT(refusal_of(with_entity(23, "CARTESIAN_POINT('',(nan,0.,140.))")), HasSubstr("#23"));
  EXPECT_THAT(refusal_of(with_entity(23, "CARTESIAN_POINT('',(1e999,0.,140.))")), HasSubstr("#23"));
  EXPECT_THAT(refusal_of(with_entity(21, "EDGE_CURVE('',#22,#24,#21,.T.)")), HasSubstr("#21"));
  EXPECT_THAT(refusal_of(with_entity(27, "CIRCLE('',#26,80.)")), HasSubstr("circle"));
  EXPECT_THAT(refusal_of(with_entity(12, "X" + std::string(200'000, '(') + std::string(200'000, ')'))),
              HasSubstr("#12"));
  EXPECT_THAT(refusal_of(with(good_part(), "#24 = ", "#23 = ")), HasSubstr("#23 is there twice"));
  EXPECT_THAT(refusal_of(with(good_part(), "ENDSEC;\nEND-ISO",
                              "#401=NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',#5,#5,$);\nENDSEC;\nEND-ISO")),
              HasSubstr("circular assembly"));
}

TEST(StepText, LineBreaksAndCommentsBeforeTheEqualsSignFallAway) {
  const StepText broken = read_step_text(with(good_part(), "#12 = ", "#12\r\n /* a comment */ = "));
  EXPECT_EQ(broken.text, read_step_text(good_part()).text);
}

TEST(StepText, UnsetNamesOfShapesAreEmptyOnes) {
  const StepText step = read_step_text(with_all(good_part(), "ADVANCED_FACE(''", "ADVANCED_FACE($"));
  EXPECT_EQ(step.text.find("ADVANCED_FACE($"), std::string::npos);
  EXPECT_EQ(read_step_text(with_all(good_part(), "CARTESIAN_POINT(''", "CARTESIAN_POINT($")).text,
            read_step_text(good_part()).text);
  // The first value of a unit is its prefix, and an unset one means something.
  const std::string unit = "#401=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));\nENDSEC;\nEND-ISO";
  EXPECT_NE(read_step_text(with(good_part(), "ENDSEC;\nEND-ISO", unit)).text.find("SI_UNIT($,.METRE.)"),
            std::string::npos);
}

std::string with_operator(const std::string& axes_and_scale) {
  return with(good_part(), "ENDSEC;\nEND-ISO",
              "#401=DIRECTION('',(1.,0.,0.));\n#402=DIRECTION('',(0.,1.,0.));\n#403=DIRECTION('',(0.,0.,1.));\n"
              "#404=DIRECTION('',(0.,0.,-1.));\n#405=CARTESIAN_POINT('',(0.,0.,0.));\n"
              "#406=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',$," +
                  axes_and_scale + ");\nENDSEC;\nEND-ISO");
}

TEST(StepText, ScaledAndMirroredInstancesAreRefusedByNumber) {
  EXPECT_EQ(refusal_of(with_operator("#401,#402,#405,1.,#403")), "accepted");
  EXPECT_EQ(refusal_of(with_operator("$,$,#405,$,$")), "accepted");
  EXPECT_EQ(refusal_of(with_operator("$,$,#405,2.,$")),
            "#406: an instance of a part is scaled by 2, which cannot be read; apply it to the part in the CAD program "
            "and export again");
  EXPECT_THAT(refusal_of(with_operator("#401,#402,#405,1.,#404")),
              HasSubstr("#406: an instance of a part is mirrored"));
  const std::string simple = with_operator("$,$,#405,1.,$");
  const std::string complex = with(simple, "CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',$,$,$,#405,1.,$)",
                                   "(CARTESIAN_TRANSFORMATION_OPERATOR(#401,#402,#405,1.)CARTESIAN_TRANSFORMATION_"
                                   "OPERATOR_3D(#404)REPRESENTATION_ITEM(''))");
  EXPECT_THAT(refusal_of(complex), HasSubstr("#406: an instance of a part is mirrored"));
}

TEST(StepText, HiddenBodiesAreListed) {
  const std::string body = "#401=MANIFOLD_SOLID_BREP('fixture',#12);\n";
  const auto hidden = [&](const std::string& more) {
    return read_step_text(with(good_part(), "ENDSEC;\nEND-ISO", body + more + "ENDSEC;\nEND-ISO")).hidden;
  };
  using ::testing::ElementsAre;
  EXPECT_THAT(hidden("#402=STYLED_ITEM('',(),#401);\n#403=INVISIBILITY((#402));\n"), ElementsAre(401));
  EXPECT_THAT(hidden("#402=PRESENTATION_LAYER_ASSIGNMENT('off','',(#401));\n#403=INVISIBILITY((#402));\n"),
              ElementsAre(401));
  EXPECT_THAT(hidden("#402=STYLED_ITEM('',(),#401);\n#404=PRESENTATION_LAYER_ASSIGNMENT('off','',(#402));\n"
                     "#403=INVISIBILITY((#404));\n"),
              ElementsAre(401));
  // An overriding style hides its own item, not that of the style behind it.
  EXPECT_THAT(hidden("#402=STYLED_ITEM('',(),#401);\n#405=OVER_RIDING_STYLED_ITEM('',(),#400,#402);\n"
                     "#403=INVISIBILITY((#405));\n"),
              ElementsAre(400));
  EXPECT_THAT(hidden("#402=STYLED_ITEM('',(),#401);\n"), ElementsAre());
}

// Edition 3 of ISO 10303-21 has more sections; several of data are one.
TEST(StepText, SectionsOfEdition3AreRead) {
  const StepText plain = read_step_text(good_part());
  EXPECT_EQ(read_step_text(with(good_part(), "ENDSEC;\nDATA;", "ENDSEC;\nANCHOR;\n<a>=#12;\nENDSEC;\nDATA;")).text,
            plain.text);
  EXPECT_EQ(read_step_text(with(good_part(), "END-ISO-10303-21;", "SIGNATURE;\nabc=\nENDSEC;\nEND-ISO-10303-21;")).text,
            plain.text);
  EXPECT_THAT(read_step_text(with(good_part(), "ENDSEC;\nDATA;", "ENDSEC;\nREFERENCE;\n#9=<b.stp#x>;\nENDSEC;\nDATA;"))
                  .warnings,
              ::testing::Contains(HasSubstr("section REFERENCE")));
  const StepText two = read_step_text(with(
      good_part(), "ENDSEC;\nEND-ISO", "ENDSEC;\nDATA('b',('X'));\n#9001=DIRECTION('',(1.,0.,0.));\nENDSEC;\nEND-ISO"));
  EXPECT_EQ(two.faces, plain.faces);
  EXPECT_NE(two.text.find("#9001=DIRECTION"), std::string::npos);
  EXPECT_EQ(two.text.find("DATA"), two.text.rfind("DATA"));
}

// Returns the name with the escapes that every reader knows.
std::string name_in_text(const std::string& name) {
  const StepText step = read_step_text(with(good_part(), "ADVANCED_FACE('outer'", "ADVANCED_FACE('" + name + "'"));
  const std::size_t at = step.text.find("ADVANCED_FACE('") + 15;
  return step.text.substr(at, step.text.find("',", at) - at);
}

TEST(StepText, NamesInAnyEncodingBecomeEscapes) {
  EXPECT_EQ(name_in_text("Geh\\X\\E4use"), "Geh\\X2\\00E4\\X0\\use");
  EXPECT_EQ(name_in_text("Geh\\S\\duse"), "Geh\\X2\\00E4\\X0\\use");                // D is 0x64, ä is 0xE4.
  EXPECT_EQ(name_in_text("Geh\xC3\xA4use"), "Geh\\X2\\00E4\\X0\\use");              // The input is UTF-8.
  EXPECT_EQ(name_in_text("Geh\xE4use"), "Geh\\X2\\00E4\\X0\\use");                  // The input is ISO 8859-1.
  EXPECT_EQ(name_in_text("\xCD\xE2\xBF\xC7"), "\\X2\\5916\\X0\\\\X2\\58F3\\X0\\");  // The input is 外壳 in GBK.
  EXPECT_EQ(name_in_text("\\X2\\591658F3\\X0\\"), "\\X2\\5916\\X0\\\\X2\\58F3\\X0\\");
  EXPECT_EQ(name_in_text("\\X2\\D83EDD16\\X0\\"), "\\X4\\0001F916\\X0\\");  // The input is a surrogate pair.
  EXPECT_EQ(name_in_text("\\PB\\\\S\\#"), "\\X2\\0141\\X0\\");              // Ł is 0xA3 in ISO 8859-2.
  EXPECT_EQ(name_in_text("it''s a \\\\ path"), "it''s a \\\\ path");
  EXPECT_EQ(name_in_text("two\nlines\x01"), "twolines");
}

TEST(StepText, UnitsMustBelongToTheShape) {
  EXPECT_FALSE(
      read_step_text(with(good_part(), "GLOBAL_UNIT_ASSIGNED_CONTEXT\n((#350,#351,#352))", "")).has_length_unit);
}

TEST(StepText, NamesExternalFiles) {
  const StepText step = read_step_text(
      with(good_part(), "ENDSEC;\nEND-ISO", "#401=DOCUMENT_FILE('arm.stp','','',#2,'',$);\nENDSEC;\nEND-ISO"));
  EXPECT_EQ(step.external_files, std::vector<std::string>{"arm.stp"});
}

}  // namespace
}  // namespace triskin::cad
