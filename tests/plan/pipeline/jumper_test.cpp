// SPDX-License-Identifier: GPL-3.0-or-later
// Tests where jumpers are possible, how the file states them, and which damage `check` names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "support/jumpered_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/design/joint.hpp"
#include "triskin/exports/export.hpp"

namespace triskin::pipeline {
namespace {

namespace fs = std::filesystem;
using design::Vec3;
using nlohmann::json;

// Makes a module on the plane with its side 0 from a to b.
design::PlacedModule module_on(const Vec3& a, const Vec3& b, int island) {
  design::PlacedModule m;
  const Vec3 along = (b - a).normalized(), up(0, 0, 1);
  m.island = island;
  m.corner_mm = {a, Vec3(a + 30.0 * along), Vec3(a + 15.0 * along + design::kHeight_mm * up.cross(along))};
  return m;
}

// Sides 0 of two modules face each other across `gap_mm`; the second is shifted along the seam.
design::ModuleLayout facing(double gap_mm, double shift_mm) {
  design::ModuleLayout layout;
  layout.islands = 2;
  layout.modules = {module_on({0, 0, 0}, {30, 0, 0}, 0),
                    module_on({30 + shift_mm, -gap_mm, 0}, {shift_mm, -gap_mm, 0}, 1)};
  return layout;
}

mesh::Surface plane() {
  return mesh::Surface(test::flat_design("plane", {-200, -200}, {200, 200}).surface);
}

TEST(Jumper, its_length_is_that_between_the_middles_of_the_sides) {
  const auto found = routing::find_jumpers(plane(), facing(9.0, 12.0), {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].node, (std::array{0, 1}));
  EXPECT_EQ(found[0].side, (std::array{0, 0}));
  EXPECT_NEAR(found[0].length_mm, 15.0, 1e-9);
  EXPECT_NEAR(found[0].fold_rad, 0.0, 1e-6);
  EXPECT_TRUE(routing::find_jumpers(plane(), facing(9.1, 12.0), {}).empty());
  design::LayoutLimits none;
  none.jumper_mm = 0.0;
  EXPECT_TRUE(routing::find_jumpers(plane(), facing(2.0, 0.0), none).empty());
}

TEST(Jumper, sides_of_one_island_and_sides_that_look_past_each_other_are_not_joined) {
  design::ModuleLayout same = facing(5.0, 0.0);
  same.modules[1].island = 0;
  EXPECT_TRUE(routing::find_jumpers(plane(), same, {}).empty());
  // Both modules face the same way, one behind the other.
  design::ModuleLayout behind;
  behind.islands = 2;
  behind.modules = {module_on({0, 0, 0}, {30, 0, 0}, 0), module_on({0, 34, 0}, {30, 34, 0}, 1)};
  for (const design::Jumper& j : routing::find_jumpers(plane(), behind, {})) EXPECT_NE(j.side, (std::array{0, 0}));
}

TEST(Jumper, the_way_over_a_ridge_is_longer_than_the_straight_line) {
  // Two planes meet along the x axis, each falling by 45°, so the feet of the straight line lie on both slopes.
  design::Mesh roof;
  roof.vertices = {{-100, 0, 0}, {100, 0, 0}, {-100, 80, -80}, {100, 80, -80}, {-100, -80, -80}, {100, -80, -80}};
  roof.faces = {{0, 1, 3}, {0, 3, 2}, {0, 4, 5}, {0, 5, 1}};
  const mesh::Surface surface(roof);
  // The ends are 5 mm down each slope from the ridge, d = 5 / √2 = 3.54 mm across. The foot of a point of it at y
  // lies at (y + d) / 2: half way up each slope (2 × 2.5 mm), and straight across where the closest point changes
  // sides (d).
  const double d = 5.0 / std::sqrt(2.0);
  EXPECT_NEAR(routing::jumper_length_mm(surface, {0, d, -d}, {0, -d, -d}), 5.0 + d, 0.2);
}

TEST(Jumper, a_module_in_between_is_not_crossed) {
  // A third module, on its own island, lies between the two sides.
  design::ModuleLayout layout = facing(14.0, 0.0);
  layout.islands = 3;
  layout.modules.push_back(module_on({15, -10, 0}, {15, -40, 0}, 2));
  for (design::Vec3& c : layout.modules[2].corner_mm) c += Vec3(-8, 8, 0);
  for (const design::Jumper& j : routing::find_jumpers(plane(), layout, {})) EXPECT_NE(j.node, (std::array{0, 1}));
}

// Below the side of module 0 lie two others side by side, one 8 mm and one 10 mm away; the side has room for one cable.
TEST(Jumper, a_fitted_one_stays_where_a_shorter_one_would_be_possible) {
  design::ModuleLayout layout = facing(8.0, -15.5);
  layout.islands = 3;
  layout.modules.push_back(facing(10.0, 15.5).modules[1]);
  layout.modules[2].island = 2;
  design::LayoutLimits limits;
  limits.jumper_mm = 20.0;
  const auto ends_at_module_0 = [&](std::span<const design::Jumper> fitted) {
    std::vector<std::array<int, 2>> ends;
    for (const design::Jumper& j : routing::find_jumpers(plane(), layout, limits, fitted)) {
      if (j.node[0] == 0 && j.side[0] == 0) ends.push_back(j.node);
    }
    return ends;
  };
  EXPECT_THAT(ends_at_module_0({}), testing::ElementsAre(std::array{0, 1}));
  design::Jumper fitted;
  fitted.node = {0, 2};
  fitted.side = {0, 0};
  EXPECT_THAT(ends_at_module_0({&fitted, 1}), testing::ElementsAre(std::array{0, 2}));
}

class JumperedFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("jumpers." + std::to_string(::getpid()));
    fs::create_directories(folder_);
    std::mt19937_64 random(5);
    design_ =
        test::jumpered_design(21, 7, random);  // The 28 modules need two controllers with a jumper, three without.
    design::write_design(folder_ / "good.json", design_);
    good_ = json::parse(read_file(folder_ / "good.json"));
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::vector<std::string> broken_by(const std::function<void(json&)>& damage) {
    json j = good_;
    damage(j);
    std::ofstream(folder_ / "damaged.json") << j.dump();
    std::vector<std::string> names;
    for (const check::Violation& v : check::check_design(folder_ / "damaged.json").violations) names.push_back(v.rule);
    return names;
  }
  void expect(const std::string& rule, const std::function<void(json&)>& damage) {
    EXPECT_THAT(broken_by(damage), testing::Contains(rule));
  }

  fs::path folder_;
  design::Design design_;
  json good_;
};

TEST_F(JumperedFile, passes_check_and_is_read_back_as_it_was) {
  EXPECT_EQ(design_.patches.size(), 2U);
  ASSERT_EQ(design_.layout.jumpers.size(), 1U);
  for (const check::Violation& v : check::check_design(folder_ / "good.json").violations)
    ADD_FAILURE() << v.rule << ": " << v.where << ": " << v.text;
  EXPECT_EQ(good_["version"], 2);
  const design::Design back = design::read_intact_design(folder_ / "good.json");
  design::write_design(folder_ / "again.json", back);
  EXPECT_EQ(read_file(folder_ / "again.json"), read_file(folder_ / "good.json"));
}

TEST_F(JumperedFile, a_file_without_jumpers_has_no_trace_of_them) {
  design::Design plain = design_;
  plain.layout.jumpers.clear();
  design::write_design(folder_ / "plain.json", plain);
  const json file = json::parse(read_file(folder_ / "plain.json"));
  EXPECT_EQ(file["version"], 1);
  EXPECT_FALSE(file.contains("jumpers"));
  EXPECT_FALSE(file["limits"].contains("jumper_mm"));
  EXPECT_FALSE(file["report"].contains("jumpers_lower_bound"));
}

TEST_F(JumperedFile, is_refused_under_the_old_version) {
  good_["version"] = 1;
  std::ofstream(folder_ / "old.json") << good_.dump();
  EXPECT_THROW((void)design::read_design(folder_ / "old.json"), InputError);
  EXPECT_THROW((void)check::check_design(folder_ / "old.json"), InputError);
}

TEST_F(JumperedFile, damage_to_a_jumper_is_named_by_its_rule) {
  const auto jumper = [](json& j) -> json& { return j["jumpers"][0]; };
  expect("jumper-kind", [&](json& j) { jumper(j)["kind"] = "wireless"; });
  expect("jumper-length", [&](json& j) { jumper(j)["length_mm"] = 4.0; });
  expect("jumper-length", [&](json& j) { j["limits"]["jumper_mm"] = 4.0; });
  expect("jumper-fold", [&](json& j) { jumper(j)["fold_rad"] = 0.3; });
  expect("jumpers-bound", [&](json& j) { j["report"]["jumpers_lower_bound"] = 2; });
  expect("design-id", [&](json& j) { jumper(j)["sides"][0] = (jumper(j)["sides"][0].get<int>() + 1) % 3; });
  expect("limits", [&](json& j) { j["limits"]["jumper_mm"] = -1.0; });
  // Without it the patch is not connected.
  const auto without = [&](json& j) {
    j.erase("jumpers");
    j["version"] = 1;
  };
  expect("patch-island", without);
  expect("rotation", without);
  // The same jumper is listed twice, so its sides are taken.
  expect("jumper-side", [&](json& j) { j["jumpers"].push_back(jumper(j)); });
  // Another side of its first module is joined, or turned away.
  for (int turn = 1; turn < 3; ++turn) {
    const auto broken =
        broken_by([&](json& j) { jumper(j)["sides"][0] = (jumper(j)["sides"][0].get<int>() + turn) % 3; });
    EXPECT_THAT(broken, testing::AnyOf(testing::Contains("jumper-side"), testing::Contains("jumper-facing")));
  }
  // Both ends are in one island.
  expect("jumper-island", [&](json& j) {
    const int first = jumper(j)["modules"][0];
    for (json& m : j["modules"]) {
      if (m["island"] == j["modules"][static_cast<std::size_t>(first)]["island"] && m["id"] > first) {
        jumper(j)["modules"][1] = m["id"];
        break;
      }
    }
  });
  // The entry cable occupies the side of the jumper.
  expect("jumper-side", [&](json& j) {
    const int first = jumper(j)["modules"][0];
    json& m = j["modules"][static_cast<std::size_t>(first)];
    m["parent"] = -1;
    m["rotation"] = jumper(j)["sides"][0];
  });
  // The ends are in two patches.
  expect("jumper-use", [&](json& j) {
    const int first = jumper(j)["modules"][0];
    json& m = j["modules"][static_cast<std::size_t>(first)];
    m["patch"] = 1 - m["patch"].get<int>();
  });
}

TEST_F(JumperedFile, a_jumper_across_a_module_or_another_jumper_is_named) {
  // A module of another island is moved under the cable.
  expect("jumper-crossing", [&](json& j) {
    const json& jumper = j["jumpers"][0];
    const auto corner = [&](std::size_t e, int k) {
      const json& c = j["modules"][jumper["modules"][e].get<std::size_t>()]["corners"][static_cast<std::size_t>(k % 3)];
      return Vec3(c[0], c[1], c[2]);
    };
    Vec3 middle(0, 0, 0);
    for (std::size_t e = 0; e < 2; ++e) {
      const int s = jumper["sides"][e];
      middle += 0.25 * (corner(e, s) + corner(e, s + 1));
    }
    json& other = j["modules"][jumper["modules"][0].get<std::size_t>() == 20 ? 19 : 20];
    Vec3 center(0, 0, 0);
    for (const json& c : other["corners"]) center += Vec3(c[0], c[1], c[2]) / 3.0;
    for (json& c : other["corners"]) {
      for (std::size_t k = 0; k < 3; ++k) c[k] = c[k].get<double>() + (middle - center)[static_cast<int>(k)];
    }
  });
}

TEST_F(JumperedFile, is_a_joint_in_the_tables_and_shown_in_picture_and_sheet) {
  const design::Jumper& jumper = design_.layout.jumpers[0];
  bool found = false;
  for (std::size_t p = 0; p < design_.patches.size(); ++p) {
    const design::PortEnds ends = design::joints_of(design_, layout::PatchIndex{p});
    const auto& modules = design_.patches[p].modules;
    for (std::size_t k = 0; k < ends.size(); ++k) {
      for (const design::PortEnd& e : ends[k]) {
        if (e.row < 0) continue;
        found = found ||
                (modules[k].node == jumper.node[0] && modules[static_cast<std::size_t>(e.row)].node == jumper.node[1]);
      }
    }
  }
  EXPECT_TRUE(found);
  EXPECT_THAT(exports::picture_svg(design_), testing::HasSubstr("class=\"jumper\""));
}

}  // namespace
}  // namespace triskin::pipeline
