// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the model that the page gets, and the page in one file.
#include "triskin/view/page.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/layout/taxel_signal.hpp"
#include "triskin/view/comparison.hpp"
#include "triskin/view/notes.hpp"
#include "triskin/view/server.hpp"

namespace triskin::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

TEST(ViewModel, has_modules_where_the_design_has_them) {
  const design::Design d = strip(20, 16);
  const json model = json::parse(view::model_json(d));
  ASSERT_EQ(model["modules"].size(), 20U);
  EXPECT_EQ(model["patches"].size(), 2U);
  const json& m = model["modules"][5];
  const auto wiring = design::wiring_of(d);
  const auto taxels = design::taxels_of(d.layout.modules[5], wiring[5].routed.rotation);
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    for (std::size_t x = 0; x < 3; ++x)
      EXPECT_NEAR(m["taxels"][3 * t + x].get<double>(), taxels[t].position_mm[static_cast<int>(x)], 0.005 + 1e-9);
  }
  EXPECT_EQ(m["parent"], 4);
  EXPECT_EQ(m["line"], 1);
  EXPECT_EQ(m["address"], 1);
  EXPECT_EQ(model["modules"][16]["patch"], 1);
  EXPECT_EQ(model["temperature_pads"], json::array({6, 10}));
  EXPECT_EQ(m["metrics"].size(), model["metrics"].size());
}

TEST(ViewModel, has_jumpers_and_cut_corners) {
  design::Design d = strip(2);
  d.layout.corner_cut_mm = 3.5;
  d.layout.jumpers.push_back({{0, 1}, {0, 1}, 12.5, 0.0, design::JumperKind::kCable});
  const json model = json::parse(view::model_json(d));
  EXPECT_EQ(model["corner_cut_mm"], 3.5);
  EXPECT_EQ(model["jumpers"], json::parse(R"([{"name":"J0-1","modules":[0,1],"sides":[0,1],"length_mm":12.5}])"));
}

TEST(ViewModel, has_findings_at_their_modules_and_covers_by_name) {
  const design::Design d = strip(20, 16);
  const auto findings =
      view::findings_in(R"({"findings":[{"module":17,"patch":1,"text":"is absent","remedy":"solder it"},)"
                        R"({"module":null,"patch":0,"text":"does not answer","remedy":"plug it in"}]})",
                        "report.json", d, {});
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].module, 17);
  EXPECT_EQ(findings[1].module, -1);
  EXPECT_EQ(findings[1].patch, 0);
  view::Notes notes;
  notes.findings = findings;
  notes.covers = {{"arm", 0, 0, 0, 20, 120.0, 0.75}};
  const json model = json::parse(view::model_json(d, false, notes));
  EXPECT_EQ(model["findings"][0]["remedy"], "solder it");
  EXPECT_EQ(model["covers"][0]["name"], "arm");
  EXPECT_EQ(model["covers"][0]["coverage"], 0.75);
}

TEST(ViewModel, findings_of_a_robot_are_counted_on) {
  design::Design d = strip(20, 10);
  for (int k = 0; k < 20; ++k) d.layout.numbers.push_back(k % 10);  // Each cover has its own numbers.
  const std::vector<view::CoverNote> covers{{"arm", 0, 0, 0, 10, 0.0, 0.0}, {"leg", 10, 1, 1, 10, 0.0, 0.0}};
  const auto findings = view::findings_in(
      R"({"covers":[{"cover":"arm","findings":[]},{"cover":"leg","findings":[{"module":3,"patch":0,"text":"t"}]}]})",
      "r", d, {.covers = covers});
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].module, 13);
  EXPECT_EQ(findings[0].patch, 1);
}

// Five of six modules stay, the sixth is removed, and another one appears 40 mm beside the strip.
TEST(ViewComparison, tells_kept_added_and_removed_modules_apart) {
  const design::Design before = strip(6);
  design::Design after = strip(6);
  for (auto& corner : after.layout.modules[5].corner_mm) corner += design::Vec3(0, 40, 0);
  std::ranges::rotate(after.layout.modules[2].corner_mm, after.layout.modules[2].corner_mm.begin() + 1);
  const view::Comparison c = view::compare(before, after);
  ASSERT_EQ(c.notes.changes.modules.size(), 12U);
  using Kind = view::ModuleChange::Kind;
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(c.notes.changes.modules[k].kind, Kind::kKept);
    EXPECT_EQ(c.notes.changes.modules[k].other, static_cast<int>(k) + 6);
    EXPECT_EQ(c.notes.changes.modules[k + 6].other, static_cast<int>(k));
  }
  EXPECT_EQ(c.notes.changes.modules[5].kind, Kind::kRemoved);
  EXPECT_EQ(c.notes.changes.modules[11].kind, Kind::kAdded);
  EXPECT_EQ(c.notes.changes.modules[11].other, -1);
  const json model = json::parse(view::model_json(c.design, false, c.notes));
  EXPECT_EQ(model["changes"][11]["what"], "added");
  EXPECT_EQ(model["before"]["modules"], 6);
  EXPECT_EQ(model["before"]["vertices"], before.surface.vertices.size());
  EXPECT_EQ(model["covers"][1]["name"], "after");
  const auto findings =
      view::findings_in(R"({"findings":[{"module":3,"patch":0,"text":"t"}]})", "r", c.design, c.notes);
  EXPECT_EQ(findings[0].module, 6 + 3);  // of the later design
  EXPECT_EQ(findings[0].patch, static_cast<int>(before.patches.size()));
  EXPECT_EQ(model["live"], false);
}

TEST(ViewComparison, refuses_other_corner_cuts) {
  design::Design cut = strip(2);
  cut.layout.corner_cut_mm = 3.5;
  EXPECT_THROW((void)view::compare(strip(2), cut), InputError);
}

TEST(ViewModel, has_angles_in_degrees) {
  design::Design d = strip(2);
  d.limits.fold_rad = 0.5;
  d.layout.modules[0].fold_rad = {0.25, 0, 0};
  const json model = json::parse(view::model_json(d));
  EXPECT_EQ(model["metrics"][2]["unit"], "°");
  EXPECT_NEAR(model["metrics"][2]["limit"].get<double>(), 28.65, 0.005 + 1e-9);
  EXPECT_NEAR(model["modules"][0]["metrics"][2].get<double>(), 14.324, 0.0005 + 1e-9);
}

TEST(ViewModel, a_report_that_is_none_is_refused_with_its_name) {
  const design::Design d = strip(20, 16);
  const std::vector<view::CoverNote> covers{{"arm", 0, 0, 0, 20, 0.0, 0.0}};
  for (const char* text :
       {"", "[]", "{}", "\xFF\xFE", R"({"findings":3})", R"({"findings":[7]})", R"({"findings":[{"module":"x"}]})",
        R"({"findings":[{"module":20}]})", R"({"covers":[{"cover":"leg","findings":[]}]})"}) {
    try {
      (void)view::findings_in(text, "report.json", d, {.covers = covers});
      ADD_FAILURE() << text << " was taken";
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr("report.json")) << text;
    }
  }
}

// A plate 2.5 mm thick lies under two of three modules; the third has only the upper side under it.
TEST(ViewModel, knows_the_wall_under_each_module) {
  design::Design d = strip(3);
  EXPECT_TRUE(view::wall_under_modules(d).empty()) << "no part, no wall";
  design::Mesh part;
  part.vertices = {{-100, -100, 0.5}, {200, -100, 0.5}, {200, 100, 0.5}, {-100, 100, 0.5},
                   {-100, -100, -2},  {26, -100, -2},   {26, 100, -2},   {-100, 100, -2}};
  part.faces = {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}};
  d.side = design::PartSide{"outer", true, 2.5, part};
  const std::vector<double> wall = view::wall_under_modules(d);
  ASSERT_EQ(wall.size(), 3U);
  EXPECT_NEAR(wall[0], 2.5, 1e-9);
  EXPECT_NEAR(wall[2], 0.0, 1e-9);
}

// The surface of the strip is the upper side of a plate; its lower side is the rest.
TEST(ViewModel, has_the_faces_of_the_part_that_are_not_covered) {
  design::Design d = strip(3);
  EXPECT_TRUE(view::left_out_of_part(d).faces.empty()) << "no part, no rest";
  design::Mesh part;
  part.vertices = {{-1, -1, 0},  {1000, -1, 0},  {1000, 30, 0},  {-1, 30, 0},
                   {-1, -1, -2}, {1000, -1, -2}, {1000, 30, -2}, {-1, 30, -2}};
  part.faces = {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}};
  d.side = design::PartSide{"outer", true, 2.0, part};
  const json rest = json::parse(view::model_json(d))["side"]["left_out"];
  EXPECT_EQ(rest["faces"], json({0, 1, 2, 0, 3, 1}));
  EXPECT_EQ(rest["vertices"].size(), 12U);
  EXPECT_EQ(rest["vertices"][2], -2.0);
}

TEST(ViewPage, keeps_a_name_from_a_file_out_of_the_script) {
  design::Design d = strip(1);
  d.name = "</script><script>alert(1)</script>";
  EXPECT_THAT(view::model_json(d), Not(HasSubstr("<")));
  EXPECT_EQ(json::parse(view::model_json(d))["name"], d.name);
}

// A browser learns of most files only when it has read those that import them.
TEST(ViewPage, a_server_names_all_scripts_and_the_model_at_once) {
  if (!view::has_page()) GTEST_SKIP() << "left out: libjs-three is not installed";
  const view::Site site = view::site_of(strip(4));
  const std::string& document = site.at("").body;
  std::size_t scripts = 0;
  for (const auto& [name, file] : site) {
    if (!name.ends_with(".js")) continue;
    EXPECT_THAT(document, HasSubstr("<link rel=\"modulepreload\" href=\"" + name + "\">"));
    ++scripts;
  }
  EXPECT_GT(scripts, 10U);
  EXPECT_THAT(document, HasSubstr("<link rel=\"preload\" href=\"model.json\""));
  EXPECT_LT(document.find("modulepreload"), document.find("</head>"));
}

TEST(ViewPage, is_one_file_that_asks_for_nothing) {
  if (!view::has_page()) GTEST_SKIP() << "built without three.js";
  const std::string html = view::page_html(strip(4));
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
  EXPECT_THAT(html, HasSubstr("Permission is hereby granted"));
  EXPECT_THAT(html, HasSubstr("\"page/three.js\":\"data:text/javascript;base64,"));
  for (const char* outside : {" src=\"", " href=\"", "@import", "url("})
    EXPECT_THAT(html, Not(HasSubstr(outside))) << outside;
}

TEST(ViewPage, embeds_every_file_whole) {
  ASSERT_TRUE(view::assets().contains("index.html"));
  EXPECT_TRUE(view::assets().at("index.html").bytes.ends_with("</html>\n"));
  EXPECT_TRUE(view::assets().at("main.js").bytes.starts_with("// SPDX"));
  EXPECT_EQ(view::assets().at("main.js").type, "text/javascript; charset=utf-8");
}

// The page must call the same taxels pressed as the program.
TEST(ViewPage, has_the_threshold_of_the_program) {
  EXPECT_THAT(view::assets().at("colors.js").bytes,
              HasSubstr(fmt::format("export const PRESSED_COUNTS = {};\n", layout::kPressed_counts)));
}

}  // namespace
}  // namespace triskin::test
