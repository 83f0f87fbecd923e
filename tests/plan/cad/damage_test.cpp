// SPDX-License-Identifier: GPL-3.0-or-later
// Each damaged part must be refused in one sentence, read with a note about the damage, or read correctly. None may end
// or hang this process, or fill its memory.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <random>

#include "step_edits.hpp"
#include "triskin/base/address_sanitizer.hpp"
#include "triskin/base/error.hpp"
#include "triskin/cad/read_part.hpp"

namespace triskin::cad {
namespace {

using test::good_part;
using test::with;
using test::with_all;
using test::with_entity;

constexpr double kTrueArea_mm2 = 39871.7;

struct Damage {
  std::string name;
  std::string bytes;
};

void PrintTo(const Damage& damage, std::ostream* out) {
  *out << damage.name;
}

std::string noise(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  std::string out;
  while (out.size() < size) out += static_cast<char>(random() & 0xFFU);
  return out;
}

std::string flipped(std::string text, int bits, unsigned seed) {
  std::mt19937 random(seed);
  for (int k = 0; k < bits; ++k) {
    char& byte = text[random() % text.size()];
    byte = static_cast<char>(byte ^ (1 << random() % 8));
  }
  return text;
}

std::string cut_at(const std::string& place, std::size_t after = 0) {
  return good_part().substr(0, good_part().find(place) + after);
}

std::string added(const std::string& entities) {
  return with(good_part(), "ENDSEC;\nEND-ISO", entities + "ENDSEC;\nEND-ISO");
}

std::string utf16(const std::string& text) {
  std::string out = "\xff\xfe";
  for (const char c : text) out += std::string{c, '\0'};
  return out;
}

std::vector<Damage> not_a_part() {
  return {{"empty", ""},
          {"blanks", "   \n\n  \t"},
          {"magic_alone", "ISO-10303-21;"},
          {"noise", noise(20'000, 1)},
          {"noise_after_header", cut_at("DATA;", 6) + noise(20'000, 2)},
          {"zeros", std::string(20'000, '\0')},
          {"zeros_in_the_middle", good_part().substr(0, 8000) + std::string(4000, '\0') + good_part().substr(12'000)},
          {"utf16", utf16(good_part())},
          {"gzip", "\x1f\x8b\x08" + noise(2000, 3)},
          {"zip", "PK\x03\x04" + noise(2000, 4)},
          {"web_page", "<!DOCTYPE html><html><body>404</body></html>"},
          {"json", "{\"asset\":{}}"},
          {"stl", "solid cover\n facet normal 0 0 1\nendsolid\n"},
          {"lfs_pointer", "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n"},
          {"bom_and_nothing", "\xEF\xBB\xBF"},
          {"end_only", "ISO-10303-21;\nEND-ISO-10303-21;\n"},
          {"header_only", cut_at("DATA;") + "END-ISO-10303-21;\n"},
          {"empty_data", cut_at("DATA;", 6) + "ENDSEC;\nEND-ISO-10303-21;\n"}};
}

std::vector<Damage> broken_syntax() {
  return {
      {"cut_in_header", cut_at("FILE_NAME", 20)},
      {"cut_in_entity", cut_at("#196 =", 12)},
      {"cut_in_string", cut_at("ADVANCED_FACE('outer'", 18)},
      {"cut_after_entity", cut_at("#196 =")},
      {"cut_before_end", cut_at("END-ISO")},
      {"bits_flipped_97", flipped(good_part(), 97, 5)},
      {"bits_flipped_5", flipped(good_part(), 5, 6)},
      {"bits_flipped_1", flipped(good_part(), 1, 7)},
      {"bracket_open", with(good_part(), "(80.,0.,140.)", "(80.,0.,140.")},
      {"bracket_too_many", with(good_part(), "(80.,0.,140.)", "(80.,0.,140.))")},
      {"deep_brackets", with_entity(12, "CARTESIAN_POINT" + std::string(200'000, '(') + std::string(200'000, ')'))},
      {"wide_list", with_entity(12, "CARTESIAN_POINT('',(" + with_all(std::string(100'000, 'x'), "x", "0.,") + "0.))")},
      {"comma_twice", with(good_part(), "(80.,0.,140.)", "(80.,,0.,140.)")},
      {"comma_missing", with(good_part(), "(80.,0.,140.)", "(80. 0.,140.)")},
      {"semicolon_missing", with(good_part(), "#22 = VERTEX_POINT('',#23);", "#22 = VERTEX_POINT('',#23)")},
      {"equals_missing", with(good_part(), "#22 = ", "#22 ")},
      {"quote_missing", with(good_part(), "ADVANCED_FACE('outer'", "ADVANCED_FACE('outer")},
      {"comment_open", with(good_part(), "#22 = ", "/* #22 = ")},
      {"enumeration_open", with(good_part(), "#24,#26,.T.", "#24,#26,.T")},
      {"word_for_number", with_entity(23, "CARTESIAN_POINT('',(nan,0.,140.))")},
      {"infinite", with_entity(23, "CARTESIAN_POINT('',(-inf,0.,140.))")},
      {"overflow", with_entity(23, "CARTESIAN_POINT('',(1.E999,0.,140.))")},
      {"exponent_without_digits", with_entity(23, "CARTESIAN_POINT('',(1.E,0.,140.))")},
      {"huge_coordinate", with_entity(23, "CARTESIAN_POINT('',(1.E30,0.,140.))")},
      {"huge_id", with(good_part(), "#22 = ", "#99999999999999999999 = ")},
      {"id_zero", with(good_part(), "#22 = ", "#0 = ")},
      {"id_twice", with(good_part(), "#22 = ", "#23 = ")},
      {"entity_without_name", with_entity(22, "")},
      {"section_unknown", with(good_part(), "DATA;", "DATEN;")}};
}

std::vector<Damage> broken_references() {
  return {{"dangling", with_entity(22, "VERTEX_POINT('',#9999)")},
          {"entity_missing", with(good_part(), "#22 = VERTEX_POINT('',#23);\n", "")},
          {"self_reference", with_entity(21, "EDGE_CURVE('',#22,#24,#21,.T.)")},
          {"circle_of_two", with_entity(27, "CIRCLE('',#26,80.)")},
          {"circle_of_three", with_entity(29, "CARTESIAN_POINT('',#21)")},
          {"assembly_in_itself", added("#401 = NEXT_ASSEMBLY_USAGE_OCCURRENCE('1','a','',#5,#5,$);\n")},
          {"wrong_type", with_entity(18, "FACE_BOUND('',#33,.T.)")},
          {"surface_for_curve", with_entity(21, "EDGE_CURVE('',#22,#24,#33,.T.)")},
          {"keyword_unknown", with_entity(33, "CYLINDRICAL_SURFAKE('',#34,80.)")},
          {"no_product", with_entity(4, "PRODUCT_DEFINITION_SHAPE('','',$)")},
          {"no_shape", with(good_part(), "SHAPE_DEFINITION_REPRESENTATION", "SHAPE_DEFINITION_REPRESENTATIO")},
          {"schema_unknown", with(good_part(), "AUTOMOTIVE_DESIGN", "IFC2X3")}};
}

std::vector<Damage> broken_geometry() {
  return {{"too_few_values", with_entity(33, "CYLINDRICAL_SURFACE('',#34)")},
          {"too_many_values", with_entity(33, "CYLINDRICAL_SURFACE('',#34,80.,80.,80.)")},
          {"string_for_number", with_entity(33, "CYLINDRICAL_SURFACE('',#34,'80.')")},
          {"no_coordinates", with_entity(23, "CARTESIAN_POINT('',())")},
          {"four_coordinates", with_entity(23, "CARTESIAN_POINT('',(80.,0.,140.,1.))")},
          {"no_bounds", with(good_part(), "#139 = ADVANCED_FACE('',(#140)", "#139 = ADVANCED_FACE('',()")},
          {"no_faces", with_entity(16, "CLOSED_SHELL('',())")},
          {"no_edges", with_entity(19, "EDGE_LOOP('',())")},
          {"face_missing", with_entity(16, "CLOSED_SHELL('',(#17,#139,#216,#265,#315))")},
          {"face_twice", with_entity(16, "CLOSED_SHELL('',(#17,#17,#139,#216,#265,#315,#342))")},
          {"edge_missing", with_entity(19, "EDGE_LOOP('',(#20,#56,#84))")},
          {"edges_in_wrong_order", with_entity(19, "EDGE_LOOP('',(#20,#84,#56,#113))")},
          {"radius_zero", with_entity(33, "CYLINDRICAL_SURFACE('',#34,0.)")},
          {"radius_negative", with_entity(33, "CYLINDRICAL_SURFACE('',#34,-80.)")},
          {"radius_wrong", with_entity(33, "CYLINDRICAL_SURFACE('',#34,60.)")},
          {"radius_huge", with_entity(33, "CYLINDRICAL_SURFACE('',#34,8.E8)")},
          {"direction_zero", with_entity(36, "DIRECTION('',(0.,0.,0.))")},
          {"axes_parallel", with_entity(37, "DIRECTION('',(0.,0.,1.))")},
          {"vertex_moved", with_entity(25, "CARTESIAN_POINT('',(20.,60.,140.))")},
          {"vertices_in_one_place", with_entity(25, "CARTESIAN_POINT('',(80.,0.,140.))")},
          {"face_turned",
           with(good_part(), "ADVANCED_FACE('outer',(#18),#33,.T.)", "ADVANCED_FACE('outer',(#18),#33,.F.)")},
          {"edge_turned", with_entity(20, "ORIENTED_EDGE('',*,*,#21,.T.)")},
          {"uncertainty_huge", with(good_part(), "LENGTH_MEASURE(1.E-07)", "LENGTH_MEASURE(1.E+06)")},
          {"unit_prefix_unknown", with(good_part(), ".MILLI.", ".MYRIA.")}};
}

std::vector<Damage> all_damage() {
  std::vector<Damage> all;
  for (auto&& some : {not_a_part(), broken_syntax(), broken_references(), broken_geometry()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

// Returns what became of it: a sentence, or "right".
std::string outcome_of(const Damage& damage) {
  ReadOptions options;
  options.time_limit_s = 10.0;  // The reader is ended there; the proof is that this call returns.
  try {
    const Part part = read_part_bytes(damage.bytes, damage.name + ".step", options);
    if (!part.faults.empty()) return "fault: " + part.faults.front();
    double area = 0.0;
    for (const Face& face : part.faces) area += face.area_mm2;
    if (std::abs(area - kTrueArea_mm2) < 1e-4 * kTrueArea_mm2) return "right";
    return part.warnings.empty() ? "silently wrong" : "warning: " + part.warnings.front();
  } catch (const InputError& e) {
    return e.what();
  }
}

class DamagedPart : public ::testing::TestWithParam<Damage> {};

TEST_P(DamagedPart, IsRefusedInOneSentenceOrReadWithAWord) {
  const std::string outcome = outcome_of(GetParam());
  std::printf("%-26s %s\n", GetParam().name.c_str(), outcome.c_str());
  EXPECT_NE(outcome, "silently wrong");
  EXPECT_EQ(outcome.find('\n'), std::string::npos);
  for (const char c : outcome) EXPECT_GE(static_cast<unsigned char>(c), 0x20U);
  // The limit of addresses that bounds the reader's memory is not set under the address sanitizer.
  if (kAddressSanitizer) return;
  rusage children{};
  ASSERT_EQ(getrusage(RUSAGE_CHILDREN, &children), 0);
  EXPECT_LE(children.ru_maxrss, 1'000'000);  // The unit is kB.
}

INSTANTIATE_TEST_SUITE_P(All, DamagedPart, ::testing::ValuesIn(all_damage()),
                         [](const auto& one) { return one.param.name; });

TEST(DamagedParts, AreOfSixtyKinds) {
  EXPECT_GE(all_damage().size(), 60U);
}

// Input that cannot be a part is refused, never read.
TEST(DamagedParts, BrokenSyntaxIsRefused) {
  for (const Damage& damage : not_a_part())
    EXPECT_THROW((void)read_part_bytes(damage.bytes, damage.name), InputError) << damage.name;
}

}  // namespace

}  // namespace triskin::cad
