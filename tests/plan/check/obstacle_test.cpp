// SPDX-License-Identifier: GPL-3.0-or-later
// These tests cover bodies that modules keep clear of, strips along borders, and places where cables enter: designs
// obey them, and check finds violations. The part is a plate of 200 mm by 110 mm at z = 0.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
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
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

design::Mesh cuboid(const Vec3& low, const Vec3& high) {
  design::Mesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.vertices.emplace_back(k & 1 ? high.x() : low.x(), k & 2 ? high.y() : low.y(), k & 4 ? high.z() : low.z());
  mesh.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

void append(std::ofstream& out, const char* name, const design::Mesh& mesh, std::size_t first) {
  out << "o " << name << "\n";
  for (const Vec3& v : mesh.vertices) out << "v " << v.x() << " " << v.y() << " " << v.z() << "\n";
  for (const auto& f : mesh.faces)
    out << "f " << first + static_cast<std::size_t>(f[0]) << " " << first + static_cast<std::size_t>(f[1]) << " "
        << first + static_cast<std::size_t>(f[2]) << "\n";
}

class ObstacleDesign : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("obstacles." + std::to_string(::getpid()));
    fs::create_directories(folder_);
    plate_ = sheet_mesh(20, 11, [](int c, int r) { return Vec3(10.0 * c, 10.0 * r, 0.0); });
  }
  void TearDown() override { fs::remove_all(folder_); }

  // The part's file contains the plate and, if the test has one, the body as an object of its own.
  design::Design design_with(const json& regions, const design::Mesh& body = {}) {
    {
      std::ofstream out(folder_ / "plate.obj");
      append(out, "plate", plate_, 1);
      if (!body.faces.empty()) append(out, "body", body, 1 + plate_.vertices.size());
    }
    if (!body.faces.empty()) mesh::write_obj(folder_ / "body.obj", body);
    std::ofstream(folder_ / "regions.json")
        << json{{"format", "triskin-regions"}, {"version", 1}, {"regions", regions}}.dump();
    pipeline::DesignOptions options;
    options.object = "plate";
    options.iterations = 60;
    options.time_limit_s = 60.0;
    options.regions = design::read_region_file(folder_ / "regions.json");
    const design::Design d = pipeline::make_design(folder_ / "plate.obj", options).design;
    design::write_design(folder_ / "design.json", d);
    return design::read_design(folder_ / "design.json");
  }
  std::string refusal_of(const json& regions, const design::Mesh& body = {}) {
    try {
      design_with(regions, body);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
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
  design::Mesh plate_;
};

// Returns the least distance of all modules from a rectangle on the plate, sampled every 0.5 mm.
double clearance(const design::Design& d, double x0, double y0, double x1, double y1) {
  double least = 1e9;
  for (const auto& m : d.layout.modules) {
    for (double x = x0; x <= x1; x += 0.5) {
      for (double y = y0; y <= y1; y += 0.5)
        least = std::min(least, mesh::distance_beside(m.corner_mm, 0.0, Vec3(x, y, 0.0)));
    }
  }
  return least;
}

// A motor is 4 mm over the plate: modules of 6 mm height would hit it, those of 3 mm with 0.9 mm of air would not.
TEST_F(ObstacleDesign, modules_keep_their_height_free) {
  const design::Mesh motor = cuboid({90, 45, 4}, {110, 65, 30});
  const auto region = [](double above, double margin) {
    return json::array({{{"name", "motor"},
                         {"free", true},
                         {"obstacle", {{"file", "body.obj"}, {"above_mm", above}, {"margin_mm", margin}}}}});
  };
  const design::Design d = design_with(region(6, 3), motor);
  EXPECT_GE(d.layout.modules.size(), 25U);
  EXPECT_GE(clearance(d, 90, 45, 110, 65), 3.0 - 0.55);
  EXPECT_THAT(broken(), IsEmpty());
  EXPECT_THAT(broken_by([](json& j) { j["regions"]["list"][0]["obstacle"]["margin_mm"] = 12.0; }),
              Contains("keep-out"));
  EXPECT_THAT(broken_by([](json& j) {
                for (json& v : j["regions"]["list"][0]["obstacle"]["mesh"]["vertices"]) v[0] = v[0].get<double>() + 30;
              }),
              Contains("keep-out"));
  EXPECT_THAT(refusal_of(region(3, 0.9), motor), HasSubstr("no part of the surface lies in it"));
}

// The body reaches through the plate, and none of its triangles is near the middle of the area that it covers.
TEST_F(ObstacleDesign, the_inside_of_a_body_counts) {
  const design::Mesh block = cuboid({60, 25, -15}, {140, 85, 15});
  const design::Design d =
      design_with({{{"name", "block"}, {"free", true}, {"obstacle", {{"object", "body"}}}}}, block);
  EXPECT_GE(clearance(d, 60.5, 25.5, 139.5, 84.5), 0.0);
  EXPECT_GT(clearance(d, 62, 27, 138, 83), 0.9);
  EXPECT_THAT(broken(), IsEmpty());
}

// A rib is 5 mm under the plate, so modules that reach 6 mm deep hit it.
TEST_F(ObstacleDesign, what_lies_under_a_module_counts_by_its_depth) {
  const design::Mesh rib = cuboid({95, 0, -20}, {105, 110, -5});
  const auto region = [](double below) {
    return json::array({{{"name", "rib"}, {"free", true}, {"obstacle", {{"file", "body.obj"}, {"below_mm", below}}}}});
  };
  const design::Design d = design_with(region(6), rib);
  EXPECT_GE(clearance(d, 95.5, 0, 104.5, 110), -0.01);
  for (const auto& m : d.layout.modules) EXPECT_LE(m.keep_out_mm, 0.5);
  EXPECT_THAT(broken(), IsEmpty());
  EXPECT_THAT(refusal_of(region(4), rib), HasSubstr("no part of the surface lies in it"));
}

TEST_F(ObstacleDesign, edges_have_a_margin) {
  const design::Design d = design_with({{{"name", "edges"}, {"free", true}, {"border", {{"margin_mm", 8}}}}});
  EXPECT_GE(d.layout.modules.size(), 20U);
  for (const auto& m : d.layout.modules) {
    for (const Vec3& c : m.corner_mm) {
      EXPECT_GE(std::min({c.x(), 200 - c.x(), c.y(), 110 - c.y()}), 8.0 - 0.55);
    }
  }
  EXPECT_THAT(broken(), IsEmpty());
  EXPECT_THAT(broken_by([](json& j) { j["regions"]["list"][0]["border"]["margin_mm"] = 25.0; }), Contains("keep-out"));
}

// A hole of 20 mm by 20 mm is 28.3 mm wide from corner to corner; the outline of the plate is 228 mm wide.
TEST_F(ObstacleDesign, heads_of_screws_have_a_margin_and_the_outline_has_none) {
  std::erase_if(plate_.faces, [&](const auto& f) {
    const auto& v = plate_.vertices;
    const Vec3 m =
        (v[static_cast<std::size_t>(f[0])] + v[static_cast<std::size_t>(f[1])] + v[static_cast<std::size_t>(f[2])]) /
        3.0;
    return m.x() > 90 && m.x() < 110 && m.y() > 40 && m.y() < 60;
  });
  const auto strip = [](double max_width) {
    return json::array(
        {{{"name", "heads"}, {"free", true}, {"border", {{"margin_mm", 6}, {"max_width_mm", max_width}}}}});
  };
  const design::Design d = design_with(strip(30));
  EXPECT_GE(clearance(d, 90, 40, 110, 60), 6.0 - 0.55);
  double at_outline = 1e9;
  for (const auto& m : d.layout.modules) {
    for (const Vec3& c : m.corner_mm) at_outline = std::min({at_outline, c.x(), c.y(), 200 - c.x(), 110 - c.y()});
  }
  EXPECT_LT(at_outline, 5.0);
  EXPECT_THAT(broken(), IsEmpty());
  EXPECT_THAT(broken_by([](json& j) { j["regions"]["list"][0]["border"]["max_width_mm"] = 300.0; }),
              Contains("keep-out"));
  EXPECT_THAT(refusal_of(strip(28)), HasSubstr("no border of that width"));
}

Vec3 entry_of(const design::Design& d, const design::Patch& p) {
  const auto& corner = d.layout.modules[static_cast<std::size_t>(p.entry)].corner_mm;
  const auto side = static_cast<std::size_t>(p.modules.front().rotation);
  return 0.5 * (corner[side] + corner[(side + 1) % 3]);
}

// The duct runs along the lower edge, where every controller can reach it.
TEST_F(ObstacleDesign, cables_enter_at_the_duct) {
  const design::Design d = design_with(
      {{{"name", "duct"}, {"entry", true}, {"box", {{"low_mm", {-5, -5, -5}}, {"high_mm", {205, 22, 5}}}}}});
  ASSERT_GE(d.patches.size(), 2U);
  EXPECT_THAT(d.report.entries_elsewhere, IsEmpty());
  for (const auto& p : d.patches) EXPECT_LE(entry_of(d, p).y(), 22.0);
  EXPECT_THAT(broken(), IsEmpty());
  EXPECT_THAT(broken_by([](json& j) { j["regions"]["list"][0]["box"]["high_mm"] = {205, 0, 5}; }),
              Contains("entry-place"));
  EXPECT_THAT(broken_by([](json& j) { j["report"]["entries_elsewhere"] = {0}; }), Contains("entry-place"));
}

// The only connector is at one corner of the plate; the report must name the controller that cannot reach it.
TEST_F(ObstacleDesign, a_controller_without_an_entry_is_named) {
  const design::Design d = design_with(
      {{{"name", "connector"}, {"entry", true}, {"sphere", {{"center_mm", {20, 20, 0}}, {"radius_mm", 25}}}}});
  ASSERT_GE(d.patches.size(), 2U);
  EXPECT_FALSE(d.report.entries_elsewhere.empty());
  EXPECT_LT(d.report.entries_elsewhere.size(), d.patches.size());
  for (std::size_t p = 0; p < d.patches.size(); ++p) {
    const bool is_elsewhere = std::ranges::count(d.report.entries_elsewhere, static_cast<int>(p)) > 0;
    EXPECT_EQ((entry_of(d, d.patches[p]) - Vec3(20, 20, 0)).norm() > 25.0, is_elsewhere);
  }
  EXPECT_THAT(broken(), Contains("entry-place"));
  EXPECT_THAT(broken(), testing::Each(std::string("entry-place")));
}

TEST_F(ObstacleDesign, mistakes_are_named) {
  const design::Mesh body = cuboid({90, 45, 4}, {110, 65, 30});
  const auto with = [](const json& shape) {
    json region = {{"name", "a"}, {"free", true}};
    region.update(shape);
    return json::array({region});
  };
  EXPECT_THAT(refusal_of(with({{"obstacle", {{"margin_mm", 2}}}}), body), HasSubstr("\"file\""));
  EXPECT_THAT(refusal_of(with({{"obstacle", {{"file", "none.stl"}}}}), body), HasSubstr("none.stl"));
  EXPECT_THAT(refusal_of(with({{"obstacle", {{"object", "motor"}}}}), body), HasSubstr("motor"));
  EXPECT_THAT(refusal_of(with({{"obstacle", {{"object", "body"}, {"above_mm", 900}}}}), body), HasSubstr("above_mm"));
  EXPECT_THAT(refusal_of(with({{"border", {{"margin_mm", 0}}}})), HasSubstr("margin_mm"));
  EXPECT_THAT(refusal_of(with({{"border", {{"margin", 2}}}})), HasSubstr("margin"));
}

}  // namespace
}  // namespace triskin::check
