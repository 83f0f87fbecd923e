// SPDX-License-Identifier: GPL-3.0-or-later
// A design must obey weights, keep-outs and places that must be covered, and check must find a design that does not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "checked_file.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/mesh/surface_regions.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::check {
namespace {

using design::Vec3;
using nlohmann::json;
using testing::Contains;
using testing::IsEmpty;
namespace fs = std::filesystem;

// On a plate of 200 mm by 110 mm, the faces with x < 40 mm are the group "left" of its file.
design::Mesh plate() {
  return sheet_mesh(20, 11, [](int c, int r) { return Vec3(10.0 * c, 10.0 * r, 0.0); });
}

void write_grouped(const fs::path& path, const design::Mesh& mesh) {
  std::ofstream out(path);
  for (const Vec3& v : mesh.vertices) out << "v " << v.x() << " " << v.y() << " " << v.z() << "\n";
  std::string group;
  for (const auto& f : mesh.faces) {
    const double x = (mesh.vertices[static_cast<std::size_t>(f[0])] + mesh.vertices[static_cast<std::size_t>(f[1])] +
                      mesh.vertices[static_cast<std::size_t>(f[2])])
                         .x() /
                     3.0;
    const std::string now = x < 40.0 ? "left" : "rest";
    if (now != group) out << "g " << now << "\n";
    group = now;
    out << "f " << f[0] + 1 << " " << f[1] + 1 << " " << f[2] + 1 << "\n";
  }
}

class RegionDesign : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("regions." + std::to_string(::getpid()));
    fs::create_directories(folder_);
    write_grouped(folder_ / "plate.obj", plate());
  }
  void TearDown() override { fs::remove_all(folder_); }

  design::Design design_with(const json& regions, int iterations = 60) {
    std::ofstream(folder_ / "regions.json")
        << json{{"format", "triskin-regions"}, {"version", 1}, {"regions", regions}}.dump();
    pipeline::DesignOptions options;
    options.iterations = iterations;
    options.time_limit_s = 60.0;
    if (!regions.empty()) options.regions = design::read_region_file(folder_ / "regions.json");
    design::Design d = pipeline::make_design(folder_ / "plate.obj", options).design;
    design::write_design(folder_ / "design.json", d);
    return d;
  }
  std::vector<std::string> broken_by(const std::function<void(json&)>& damage) {
    json j = json::parse(read_file(folder_ / "design.json"));
    damage(j);
    return broken_rules(j, folder_ / "damaged.json");
  }
  std::vector<std::string> broken() {
    return broken_by([](json&) {});
  }

  fs::path folder_;
};

Vec3 center_of(const design::PlacedModule& m) {
  return (m.corner_mm[0] + m.corner_mm[1] + m.corner_mm[2]) / 3.0;
}

// Returns the distance in the plane of a module from a point; 0 inside.
double distance(const design::PlacedModule& m, const Vec3& p) {
  return mesh::distance_beside(m.corner_mm, 0.0, p);
}

TEST_F(RegionDesign, a_ball_that_must_stay_free_does) {
  const Vec3 center(100, 55, 0);
  const json ball = {{"name", "hole"}, {"free", true}, {"sphere", {{"center_mm", {100, 55, 0}}, {"radius_mm", 20}}}};
  const design::Design d = design_with(json::array({ball}));
  EXPECT_THAT(broken(), IsEmpty());
  EXPECT_GE(d.layout.modules.size(), 25U);
  for (const auto& m : d.layout.modules) {
    EXPECT_GE(distance(m, center), 20.0 - 0.5);
    EXPECT_NEAR(m.keep_out_mm, std::max(0.0, 20.0 - distance(m, center)), 0.06);
  }
  // Without the region modules lie there, so the file with the region is refused.
  const design::Design all = design_with(json::array());
  EXPECT_GT(all.layout.modules.size(), d.layout.modules.size());
  const auto refused = broken_by([&](json& j) {
    j["regions"] = {{"elsewhere", 1.0}, {"list", json::array({ball})}};
    for (json& m : j["modules"]) m["keep_out_mm"] = 0.0;
  });
  EXPECT_THAT(refused, Contains("keep-out"));
  const auto found = check_design(folder_ / "damaged.json").violations;
  EXPECT_TRUE(std::ranges::any_of(
      found, [](const Violation& v) { return v.text.find("must stay free, limit 0.5 mm") != std::string::npos; }));
}

TEST_F(RegionDesign, a_flattering_keep_out_is_found) {
  design_with({{{"name", "hole"}, {"free", true}, {"box", {{"low_mm", {80, 40, -5}}, {"high_mm", {120, 70, 5}}}}}});
  EXPECT_THAT(broken(), IsEmpty());
  EXPECT_THAT(broken_by([](json& j) { j["modules"][0]["keep_out_mm"] = 0.3; }), Contains("keep-out"));
  EXPECT_THROW((void)broken_by([](json& j) { j["modules"][0].erase("keep_out_mm"); }), InputError);
  // With a slightly larger region, modules beside it now reach in.
  const auto larger = broken_by(
      [](json& j) { j["regions"]["list"][0]["box"] = {{"low_mm", {60, 20, -5}}, {"high_mm", {140, 90, 5}}}; });
  EXPECT_THAT(larger, Contains("keep-out"));
}

TEST_F(RegionDesign, a_group_of_the_file_stays_free_and_faces_are_weighed) {
  json faces = json::array();
  const design::Mesh mesh = plate();
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto is_right = [&](int v) { return mesh.vertices[static_cast<std::size_t>(v)].x() >= 150.0; };
    if (std::ranges::all_of(mesh.faces[f], is_right)) faces.push_back(f);
  }
  const design::Design d = design_with(
      {{{"name", "clear"}, {"group", "left"}, {"free", true}}, {{"name", "dear"}, {"faces", faces}, {"weight", 5.0}}});
  EXPECT_THAT(broken(), IsEmpty());
  double module_value = 0.0;
  for (const auto& m : d.layout.modules) {
    for (const Vec3& c : m.corner_mm) EXPECT_GE(c.x(), 40.0 - 0.5);
    module_value += center_of(m).x() > 150.0 ? 5.0 : 1.0;
  }
  EXPECT_NEAR(d.report.module_value, module_value, 1e-9);
  EXPECT_NEAR(d.alternatives[static_cast<std::size_t>(d.taken)].module_value, module_value, 1e-9);
}

// Balls of 10 mm, 314 mm², contain less than one centre each on a lattice that does not know them; two fit at a side.
TEST_F(RegionDesign, weight_draws_modules) {
  const std::array<Vec3, 4> places{Vec3(40, 30, 0), Vec3(83, 71, 0), Vec3(127, 38, 0), Vec3(166, 80, 0)};
  json balls = json::array();
  for (std::size_t k = 0; k < places.size(); ++k) {
    balls.push_back({{"name", std::to_string(k)},
                     {"weight", 6.0},
                     {"sphere", {{"center_mm", {places[k].x(), places[k].y(), 0}}, {"radius_mm", 10}}}});
  }
  const auto drawn_by = [&](const design::Design& d) {
    return std::ranges::count_if(d.layout.modules, [&](const auto& m) {
      return std::ranges::any_of(places, [&](const Vec3& p) { return (center_of(m) - p).norm() <= 10.0; });
    });
  };
  const design::Design plain = design_with(json::array(), 600), drawn = design_with(balls, 600);
  EXPECT_GT(drawn_by(drawn), drawn_by(plain));
  EXPECT_NEAR(drawn.report.module_value,
              static_cast<double>(drawn.layout.modules.size()) + 5.0 * static_cast<double>(drawn_by(drawn)), 1e-6);
}

TEST_F(RegionDesign, what_must_be_covered_is_or_is_named) {
  const json middle = {
      {"name", "middle"}, {"cover", true}, {"box", {{"low_mm", {70, 40, -5}}, {"high_mm", {120, 70, 5}}}}};
  const design::Design d = design_with(json::array({middle}));
  EXPECT_THAT(d.report.uncovered, IsEmpty());
  EXPECT_THAT(broken(), IsEmpty());
  EXPECT_THAT(broken_by([](json& j) {  // The value is larger than requested.
                j["regions"]["list"][0]["box"]["high_mm"] = {260, 170, 5};
              }),
              Contains("must-cover"));

  // No module reaches the corners of the plate, nor the parts that must stay free.
  const design::Design corner = design_with(
      {{{"name", "corner"}, {"cover", true}, {"sphere", {{"center_mm", {0, 0, 0}}, {"radius_mm", 4}}}},
       {{"name", "hole"}, {"free", true}, {"sphere", {{"center_mm", {100, 55, 0}}, {"radius_mm", 10}}}},
       {{"name", "in the hole"}, {"cover", true}, {"sphere", {{"center_mm", {100, 55, 0}}, {"radius_mm", 2}}}}});
  ASSERT_FALSE(corner.report.uncovered.empty());
  const design::Uncovered& last = corner.report.uncovered.back();
  EXPECT_EQ(last.region, "in the hole");
  EXPECT_EQ(last.why, "keep_out");
  EXPECT_NEAR(last.share, 1.0, 0.01);
  EXPECT_LT((last.place_mm - Vec3(100, 55, 0)).norm(), 2.1);
  EXPECT_THAT(broken(), testing::Each(std::string("must-cover")));
  EXPECT_THAT(broken(), Contains("must-cover"));
  const design::Design again = design::read_design(folder_ / "design.json");
  ASSERT_EQ(again.report.uncovered.size(), corner.report.uncovered.size());
  EXPECT_EQ(again.report.uncovered.back().why, "keep_out");
}

TEST_F(RegionDesign, alternatives_keep_the_regions) {
  const design::Design d =
      design_with({{{"name", "hole"}, {"free", true}, {"sphere", {{"center_mm", {100, 55, 0}}, {"radius_mm", 15}}}}});
  const int last = static_cast<int>(d.alternatives.size()) - 1;
  design::write_design(folder_ / "design.json",
                       pipeline::take_alternative(design::read_design(folder_ / "design.json"), last));
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(RegionDesign, mistakes_are_named) {
  const json ball = {{"center_mm", {100, 55, 0}}, {"radius_mm", 10}};
  const auto message = [&](const json& regions) -> std::string {
    try {
      design_with(regions, 1);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  using testing::HasSubstr;
  EXPECT_THAT(message({{{"name", "a"}, {"sphere", ball}}}), HasSubstr("says nothing"));
  EXPECT_THAT(message({{{"name", "a"}, {"sphere", ball}, {"free", true}, {"cover", true}}}), HasSubstr("\"a\""));
  EXPECT_THAT(message({{{"name", "a"}, {"sphere", ball}, {"wieght", 2}}}), HasSubstr("wieght"));
  EXPECT_THAT(message({{{"name", "a"}, {"sphere", ball}, {"weight", -2}}}), HasSubstr("weight"));
  EXPECT_THAT(message({{{"name", "a"}, {"weight", 2}}}), HasSubstr("needs one of"));
  EXPECT_THAT(message({{{"name", "a"}, {"group", "right"}, {"free", true}}}), HasSubstr("left, rest"));
  EXPECT_THAT(message({{{"name", "a"}, {"faces", {99999}}, {"free", true}}}), HasSubstr("99999"));
  EXPECT_THAT(message({{{"name", "a"}, {"free", true}, {"sphere", {{"center_mm", {100, 55, 90}}, {"radius_mm", 9}}}}}),
              HasSubstr("no part of the surface"));
}

}  // namespace
}  // namespace triskin::check
