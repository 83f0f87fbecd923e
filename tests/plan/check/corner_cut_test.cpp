// SPDX-License-Identifier: GPL-3.0-or-later
// The checker must accept a design with cut corners, but not the same file with another cut, or with modules where the
// cut does not suffice.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "checked_file.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/exports/export.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::check {
namespace {

using design::Vec3;
using nlohmann::json;
using testing::Contains;
using testing::Not;
namespace fs = std::filesystem;

// The plate is 150 mm by 76 mm, but three rows of whole modules are 77.9 mm high.
design::Mesh plate() {
  constexpr int kColumns = 15, kRows = 8;
  return sheet_mesh(kColumns, kRows, [](int c, int r) { return Vec3(150.0 * c / kColumns, 76.0 * r / kRows, 0.0); });
}

class CutDesign : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::temp_directory_path() / ("corner_cut." + std::to_string(::getpid()));
    fs::create_directories(folder_);
    mesh::write_obj(folder_ / "plate.obj", plate());
    pipeline::DesignOptions options;
    options.iterations = 60;
    options.time_limit_s = 60.0;
    options.corner_cut_mm = 3.0;
    design_ = new design::Design(pipeline::make_design(folder_ / "plate.obj", options).design);
    design::write_design(folder_ / "good.json", *design_);
    good_ = new json(json::parse(read_file(folder_ / "good.json")));
  }
  static void TearDownTestSuite() {
    fs::remove_all(folder_);
    delete good_;
    delete design_;
  }

  static std::vector<std::string> broken_by(const std::function<void(json&)>& damage) {
    json j = *good_;
    damage(j);
    return broken_rules(j, folder_ / "damaged.json");
  }

  static inline fs::path folder_;
  static inline json* good_ = nullptr;
  static inline design::Design* design_ = nullptr;
};

void shift(json& module, double dx, double dy) {
  for (json& c : module["corners"]) {
    c[0] = c[0].get<double>() + dx;
    c[1] = c[1].get<double>() + dy;
  }
}

Vec3 center_of(const json& module) {
  Vec3 sum = Vec3::Zero();
  for (const json& c : module["corners"]) sum += Vec3(c[0].get<double>(), c[1].get<double>(), c[2].get<double>());
  return sum / 3.0;
}

// Finds a module with the fewest others at its sides, so that there is room away from them, and the direction to the
// nearest of these. A move of 4 mm along it is 4 mm of penetration less the gap, at most the limit of a hinge (2 mm),
// while 0.5 mm is allowed.
std::pair<std::size_t, Vec3> towards_a_neighbour(const json& modules) {
  // The centres of two joined modules are at most this far apart: their regular distance plus the limit of a hinge.
  constexpr double kAtASide_mm = 30.0 / 1.7320508 + 2.0;
  std::size_t fewest = modules.size(), module = 0;
  Vec3 nearest = Vec3::UnitX();
  for (std::size_t a = 0; a < modules.size(); ++a) {
    std::vector<Vec3> ways;
    for (std::size_t b = 0; b < modules.size(); ++b) {
      const Vec3 way = center_of(modules[b]) - center_of(modules[a]);
      if (a != b && way.norm() <= kAtASide_mm) ways.push_back(way);
    }
    if (ways.empty() || ways.size() >= fewest) continue;
    fewest = ways.size();
    module = a;
    nearest = *std::ranges::min_element(ways, {}, [](const Vec3& way) { return way.norm(); });
  }
  return {module, nearest.normalized()};
}

TEST_F(CutDesign, is_accepted_and_states_coverage_both_ways) {
  const DesignReport report = check_design(folder_ / "good.json");
  for (const Violation& v : report.violations) ADD_FAILURE() << v.rule << " " << v.where << " " << v.text;
  EXPECT_THAT(report.rules, Contains("taxel-cut"));
  const json& r = (*good_)["report"];
  EXPECT_NEAR(r["coverage_cut"].get<double>() / r["coverage"].get<double>(), 1.0 - 3.0 * 0.01, 1e-12);
  EXPECT_GE((*good_)["modules"].size(), 15U);
}

TEST_F(CutDesign, another_cut_is_noticed) {
  const auto whole = broken_by([](json& j) { j.erase("corner_cut_mm"); });
  EXPECT_THAT(whole, Contains("design-id"));
  EXPECT_THAT(whole, Contains("overrun"));  // The tips extend over the border.
  EXPECT_THAT(broken_by([](json& j) { j["corner_cut_mm"] = 2.9; }), Contains("design-id"));
  EXPECT_THAT(broken_by([](json& j) { j["corner_cut_mm"] = 7.2; }), Contains("taxel-cut"));
  EXPECT_THAT(broken_by([](json& j) { j["corner_cut_mm"] = 6.8; }), Not(Contains("taxel-cut")));
  EXPECT_THAT(broken_by([](json& j) { j["report"]["coverage_cut"] = j["report"]["coverage"]; }),
              Contains("report-coverage"));
  EXPECT_THROW((void)broken_by([](json& j) { j["corner_cut_mm"] = -1.0; }), InputError);
  EXPECT_THROW((void)broken_by([](json& j) { j["corner_cut_mm"] = 11.0; }), InputError);
  EXPECT_THROW((void)broken_by([](json& j) { j["report"].erase("coverage_cut"); }), InputError);
}

TEST_F(CutDesign, moved_modules_are_found) {
  const auto [module, way] = towards_a_neighbour((*good_)["modules"]);
  const auto moved = [&](double mm) {
    return broken_by([&](json& j) { shift(j["modules"][module], mm * way.x(), mm * way.y()); });
  };
  EXPECT_THAT(moved(4.0), Contains("penetration"));
  json away = *good_;  // The shift stays below every limit.
  shift(away["modules"][module], -0.1 * way.x(), -0.1 * way.y());
  for (const Violation& v : violations_of(away, folder_ / "damaged.json"))
    EXPECT_EQ(v.text.find("overlaps"), std::string::npos) << v.where << " " << v.text;
  EXPECT_THAT(broken_by([](json& j) {
                for (json& m : j["modules"]) shift(m, 0.0, 3.0);
              }),
              Contains("overrun"));
  EXPECT_THAT(broken_by([](json& j) {
                json& stated = j["modules"][0]["penetration_mm"];
                stated = stated.get<double>() + 0.2;
              }),
              Contains("penetration"));
  EXPECT_THAT(broken_by([](json& j) {
                json& theta = j["pieces"][0]["placement"]["theta_rad"];
                theta = theta.get<double>() + 0.3;
              }),
              Contains("piece-placement"));
}

std::size_t lines_of(const std::string& text, const std::string& begin) {
  std::size_t count = 0;
  for (std::size_t k = 0; (k = text.find("\n" + begin, k)) != std::string::npos; ++k) ++count;
  return count;
}

TEST_F(CutDesign, reading_writing_and_exports_keep_the_cut) {
  const design::Design read = design::read_intact_design(folder_ / "good.json");
  EXPECT_EQ(read.layout.corner_cut_mm, 3.0);
  EXPECT_EQ(read.report.coverage_cut, design_->report.coverage_cut);
  const std::string obj = exports::modules_obj(read), svg = exports::picture_svg(read);
  EXPECT_EQ(lines_of(obj, "v "), 6 * read.layout.modules.size());
  EXPECT_EQ(lines_of(obj, "f "), read.layout.modules.size());
  EXPECT_NE(svg.find("corners cut by 3 mm"), std::string::npos);
  for (const double bad : {0.0, -1.0, 7.0}) {
    json j = *good_;
    j["corner_cut_mm"] = bad;
    std::ofstream(folder_ / "bad.json") << j.dump();
    EXPECT_THROW((void)design::read_design(folder_ / "bad.json"), InputError);
  }
}

// The positions of the taxels determine the two limits of the outline.
TEST(CornerCutLimits, follow_from_the_taxels) {
  design::PlacedModule m;
  m.corner_mm = {Vec3(0, 0, 0), Vec3(30, 0, 0), Vec3(15, design::kHeight_mm, 0)};
  const Vec3 center(15, design::kHeight_mm / 3.0, 0);
  double farthest = 0.0, to_side = 1e300;
  for (const design::TaxelPose& t : design::taxels_of(m, 0)) {
    for (const Vec3& c : m.corner_mm)
      farthest = std::max(farthest, (t.position_mm - center).dot((c - center).normalized()));
    to_side = std::min(to_side, t.position_mm.y());
  }
  EXPECT_GT(design::short_side_offset_mm(design::kMaxCornerCut_mm), farthest);
  EXPECT_LT(design::short_side_offset_mm(design::kMaxCornerCut_mm + 0.1), farthest);
  EXPECT_GT(design::short_side_offset_mm(design::kHarmlessCornerCut_mm) - farthest, to_side);
  EXPECT_LT(design::short_side_offset_mm(design::kHarmlessCornerCut_mm + 0.1) - farthest, to_side);
}

}  // namespace
}  // namespace triskin::check
