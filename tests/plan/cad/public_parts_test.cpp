// SPDX-License-Identifier: GPL-3.0-or-later
// Reads public robot parts from a folder that does not belong to the project; without it the cases are skipped and
// counted. The numbers are from its list, which was made with other code.
#include <gtest/gtest.h>

#include <filesystem>

#include "support/places.hpp"
#include "triskin/base/error.hpp"
#include "triskin/cad/read_part.hpp"

namespace triskin::cad {
namespace {

struct PublicPart {
  std::string file, unit;
  int solids;
  std::size_t faces;
  double area_cm2;
  design::Vec3 size_mm;
};

class PublicParts : public ::testing::TestWithParam<PublicPart> {};

std::filesystem::path folder() {
  const char* named = std::getenv("TRISKIN_DATA");
  return std::filesystem::path(named != nullptr ? named : test::configured_data_folder()) / "step";
}

TEST_P(PublicParts, IsReadWhole) {
  if (!std::filesystem::exists(folder()))
    GTEST_SKIP() << "left out without data: " << folder() << " does not exist (TRISKIN_SHARED_DATA)";
  const PublicPart& wanted = GetParam();
  const Part part = read_part(folder() / wanted.file);
  EXPECT_TRUE(part.faults.empty()) << (part.faults.empty() ? "" : part.faults.front());
  EXPECT_EQ(part.unit, wanted.unit);
  EXPECT_EQ(part.faces.size(), wanted.faces);
  int solids = 0;
  double area_cm2 = 0.0;
  for (const Body& body : part.bodies) {
    solids += body.is_solid ? 1 : 0;
    area_cm2 += body.area_mm2 / 100.0;
    EXPECT_EQ(body.open_edges, 0) << body.path;
  }
  EXPECT_EQ(solids, wanted.solids);
  EXPECT_NEAR(area_cm2, wanted.area_cm2, 0.1);
  EXPECT_LT((size_of(part) - wanted.size_mm).cwiseAbs().maxCoeff(), 0.2);
  // Edges of some files lie up to a tenth of a millimetre beside their surfaces; the part says so.
  EXPECT_LE(part.deviation_mm, part.warnings.empty() ? 0.05 : 0.1);
}

INSTANTIATE_TEST_SUITE_P(
    All, PublicParts,
    ::testing::Values(PublicPart{"main_body_front.stp", "inch", 1, 22, 1347.1, {145.0, 146.0, 146.0}},
                      PublicPart{"palm_shell.step", "metre", 1, 118, 333.0, {103.3, 102.9, 66.5}},
                      PublicPart{"top_shell.step", "metre", 1, 91, 233.0, {100.2, 104.9, 28.4}},
                      PublicPart{"battery_lid.step", "millimetre", 1, 151, 255.8, {154.4, 82.8, 19.4}},
                      PublicPart{"upper_arm_cover.step", "millimetre", 1, 263, 334.7, {79.0, 29.5, 124.7}},
                      PublicPart{"motor_cover_ring.step", "millimetre", 1, 60, 231.1, {94.0, 92.9, 30.0}},
                      PublicPart{"sheet_metal.stp", "inch", 1, 120, 3530.1, {485.4, 300.8, 162.5}},
                      PublicPart{"compartment.step", "millimetre", 10, 141, 3153.3, {275.0, 210.0, 98.0}},
                      PublicPart{"assembly_as1.stp", "millimetre", 18, 160, 1410.8, {200.0, 150.0, 84.0}},
                      PublicPart{"upper_arm_link.step", "millimetre", 1, 326, 279.2, {142.2, 24.5, 67.3}},
                      PublicPart{"cone_tip.step", "millimetre", 1, 12, 6.5, {9.5, 9.5, 14.4}},
                      PublicPart{"blade_upper.iges", "millimetre", 0, 1, 82.9, {70.1, 103.1, 93.4}}),
    [](const auto& one) { return one.param.file.substr(0, one.param.file.find('.')); });

TEST(PublicAssembly, OfLinksAloneIsTold) {
  if (!std::filesystem::exists(folder()))
    GTEST_SKIP() << "left out without data: " << folder() << " does not exist (TRISKIN_SHARED_DATA)";
  try {
    (void)read_part(folder() / "links_only.step");
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("other files"), std::string::npos) << e.what();
  }
}

struct OddPart {
  std::string file, said;  // An empty text means that the whole cover is read.
};

void PrintTo(const OddPart& part, std::ostream* out) {
  *out << part.file;
}

class OddParts : public ::testing::TestWithParam<OddPart> {};

std::string outcome_of(const std::filesystem::path& file) {
  try {
    const Part part = read_part(file);
    double area_cm2 = 0.0;
    for (const Face& face : part.faces) area_cm2 += face.area_mm2 / 100.0;
    std::string faults;
    for (const std::string& fault : part.faults) faults += fault + "; ";
    if (!faults.empty()) return faults;
    return std::abs(area_cm2 - 398.717) < 0.01 && part.faces.size() == 6 ? "" : std::to_string(area_cm2);
  } catch (const InputError& e) {
    return e.what();
  }
}

TEST_P(OddParts, IsReadOrToldAsItsListWants) {
  if (!std::filesystem::exists(folder()))
    GTEST_SKIP() << "left out without data: " << folder() << " does not exist (TRISKIN_SHARED_DATA)";
  const std::string outcome = outcome_of(folder() / "odd" / (GetParam().file + ".step"));
  if (GetParam().said.empty())
    EXPECT_EQ(outcome, "");
  else
    EXPECT_NE(outcome.find(GetParam().said), std::string::npos) << outcome;
}

INSTANTIATE_TEST_SUITE_P(
    All, OddParts,
    ::testing::Values(OddPart{"00_good_mm", ""}, OddPart{"01_truncated", "ends within #196"},
                      OddPart{"02_wrong_header", "looks like an STL"}, OddPart{"03_empty", "is empty"},
                      OddPart{"04_inch", ""}, OddPart{"06_no_unit", ""}, OddPart{"07_nan", "#23"},
                      OddPart{"08_face_without_bounds", "#139"}, OddPart{"09_open_shell", "195.47"},
                      OddPart{"10_self_reference", "#21"}, OddPart{"10c_assembly_in_itself", "circular assembly"},
                      OddPart{"11d_deep_brackets", "brackets"}, OddPart{"12_noise", "not a STEP file"},
                      OddPart{"13_crlf_utf8_names", ""}, OddPart{"15_escaped_names", ""},
                      OddPart{"16_hostile_names", ""}, OddPart{"18_gap_at_a_vertex", ""},
                      OddPart{"19b_line_breaks_anywhere", ""}, OddPart{"20_ap203", ""}, OddPart{"20_ap242", ""}),
    [](const auto& entry) { return "part_" + entry.param.file; });

}  // namespace
}  // namespace triskin::cad
