// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the content of the assembly sheet before anything is drawn, worked by hand on strips and on two islands.
#include "triskin/sheet/plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/sheet/bill.hpp"
#include "triskin/sheet/page_code.hpp"

namespace triskin::test {
namespace {

using design::Vec3;
using sheet::PageCode;
using sheet::PieceCount;
using sheet::SideKind;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST(PageCode, is_written_and_read) {
  const PageCode code{0x00ab00000000cdef, 3, 12};
  EXPECT_EQ(sheet::text_of(code), "triskin:00ab00000000cdef/3/12");
  EXPECT_EQ(sheet::read_page_code("triskin:00ab00000000cdef/3/12"), code);
  EXPECT_EQ(sheet::text_of({1, -1, 1}), "triskin:0000000000000001/-/1");
  EXPECT_EQ(sheet::read_page_code("triskin:0000000000000001/-/1"), (PageCode{1, -1, 1}));
}

TEST(PageCode, refuses_what_is_none) {
  for (const char* text :
       {"", "triskin:", "forearm.json", "triskin:12/0/1", "triskin:00ab00000000cdef", "triskin:00ab00000000cdef/3",
        "triskin:00ab00000000cdef/3/0", "triskin:00ab00000000cdef/-1/1", "triskin:00ab00000000cdef/3/1 ",
        "triskin:00ab00000000cdeg/3/1", "triskin:00ab00000000cdef//1", "triskin:00ab00000000cdef/3/99999999999"})
    EXPECT_FALSE(sheet::read_page_code(text)) << text;
  EXPECT_TRUE(sheet::is_page_code("triskin:12/0/1"));
  EXPECT_FALSE(sheet::is_page_code("forearm.json"));
}

// Modules 0, 1 and 2, 3 are on two controllers, in one row: 0 – 1 | 2 – 3.
TEST(Sides, of_a_strip_on_two_controllers) {
  const auto sides = sheet::sides_of(strip(4, 2));
  EXPECT_EQ(sides.of[0][1].kind, SideKind::kKept);
  EXPECT_EQ(sides.of[0][1].other, 1);
  EXPECT_EQ(sides.of[0][1].fold_rad, 0.0);
  EXPECT_EQ(sides.of[1][0].kind, SideKind::kApart);
  EXPECT_EQ(sides.of[0][0].kind, SideKind::kOutline);
  EXPECT_TRUE(sides.of[0][2].cable);
  EXPECT_TRUE(sides.of[2][2].cable);  // The cable passes through the skin, over the joint that is cut.
  EXPECT_EQ(sides.of[2][2].kind, SideKind::kApart);
  EXPECT_TRUE(sides.matches.empty());
}

TEST(Sides, cut_joints_and_slits) {
  design::Design d = strip(3, 3);
  d.patches[0].cut_joints = {{1, 2}};
  // Modules 0 and 1 lie side by side without a joint.
  d.layout.modules[0].neighbour[1] = d.layout.modules[1].neighbour[2] = -1;
  const auto sides = sheet::sides_of(d);
  EXPECT_EQ(sides.of[2][2].kind, SideKind::kCut);
  EXPECT_EQ(sides.of[0][1].kind, SideKind::kSlit);
  EXPECT_EQ(sides.of[0][1].other, 1);
  ASSERT_EQ(sides.matches.size(), 1U);  // These are the two sides of the slit.
  EXPECT_EQ(sides.matches[0].gap_mm, 0.0);
}

// On a roof, the second module bends down by 30° at the joint: seen from outside, away from the viewer.
TEST(Sides, fold_is_positive_away_from_the_viewer) {
  design::Design d = strip(2);
  auto& corners = d.layout.modules[1].corner_mm;
  const Vec3 hinge = corners[2], axis = (corners[0] - corners[2]).normalized();
  const Eigen::AngleAxisd turn(0.5235987755982988, axis);
  const Vec3 moved = hinge + turn * (corners[1] - hinge);
  const bool down = moved.z() < 0.0;
  corners[1] = down ? moved : Vec3(hinge + turn.inverse() * (corners[1] - hinge));
  ASSERT_LT(corners[1].z(), -1.0);
  EXPECT_NEAR(sheet::sides_of(d).of[0][1].fold_rad, 0.5235987755982988, 1e-9);
  corners[1].z() *= -1.0;
  EXPECT_NEAR(sheet::sides_of(d).of[0][1].fold_rad, -0.5235987755982988, 1e-9);
}

// Makes two islands of one module, 5 mm apart.
design::Design two_islands() {
  design::Design d = flat_design("two", {-10, -40}, {40, 40});
  d.layout.islands = 2;
  lay_modules(d, {{0, 0, true}}, {}, 0);
  lay_modules(d, {{0, -1, false}}, {}, 1, {0.0, -5.0});
  for (int k = 0; k < 2; ++k) {
    design::Patch patch;
    patch.entry = k;
    patch.modules.push_back({k, -1, k == 0 ? 1 : 0, 0, 0, 0});
    d.patches.push_back(patch);
  }
  d.design_id = design::design_id_of(d);
  return d;
}

TEST(Sides, that_face_each_other_over_a_seam_get_one_mark) {
  const auto sides = sheet::sides_of(two_islands());
  ASSERT_EQ(sides.matches.size(), 1U);
  EXPECT_THAT(sides.matches[0].module, ElementsAre(0, 1));
  EXPECT_THAT(sides.matches[0].side, ElementsAre(0, 1));
  EXPECT_NEAR(sides.matches[0].gap_mm, 5.0, 1e-12);
  EXPECT_EQ(sides.of[0][0].match, 0);
  EXPECT_EQ(sides.of[1][1].match, 0);
  EXPECT_EQ(sides.of[0][1].match, -1);
}

TEST(Sides, with_a_jumper_get_no_mark) {
  design::Design d = two_islands();
  d.layout.jumpers.push_back({{0, 1}, {0, 1}, 5.0, 0.0, design::JumperKind::kCable});
  const auto sides = sheet::sides_of(d);
  EXPECT_TRUE(sides.matches.empty());
  EXPECT_EQ(sides.of[1][1].jumper, 0);
}

TEST(Bill, of_a_strip) {
  const design::Design d = strip(4, 2);
  const sheet::Bill bill = sheet::bill_of(d, sheet::sides_of(d));
  EXPECT_EQ(bill.modules, 4);
  EXPECT_EQ(bill.controllers, 2);
  EXPECT_THAT(bill.line_straps, ElementsAre(4, 0, 0, 0));
  EXPECT_THAT(bill.address_straps, ElementsAre(2, 2, 0, 0));
  EXPECT_EQ(bill.kept_joints, 2);
  EXPECT_EQ(bill.apart_joints, 1);
  EXPECT_EQ(bill.cut_joints, 0);
  // Entry 0 is at (7.5, 13.0), 8.5 mm from the rim x = −1; entry 2 is at (37.5, 13.0), 14.0 mm from the rim y = −1.
  EXPECT_THAT(bill.cables, ElementsAre(PieceCount{10, 1}, PieceCount{20, 1}));
}

TEST(Bill, counts_modules_by_kind_and_controllers_say_which) {
  design::Design d = strip(4, 2);
  EXPECT_THAT(sheet::bill_of(d, sheet::sides_of(d)).modules_by_kind, ElementsAre(4));
  d.kinds.kinds = {{"soft", 10, "foam", 80.0}, {"hard", 12, "", 0.0}};
  d.layout.modules[1].kind = d.layout.modules[3].kind = d.layout.modules[2].kind = 1;
  EXPECT_THAT(sheet::bill_of(d, sheet::sides_of(d)).modules_by_kind, ElementsAre(1, 3, 0));
  std::string text;
  for (const auto& page : sheet::plan_of(d, sheet::Paper::kA4).pages) {
    for (const auto& line : page.lines) {
      for (const std::string& cell : line.cells) text += cell + "|";
    }
  }
  EXPECT_THAT(text, HasSubstr("modules|standard: 12 taxels; whole triangles, side 30 mm|1|"));
  EXPECT_THAT(text, HasSubstr("modules|soft: 10 taxels, foam; whole triangles, side 30 mm|3|"));
  EXPECT_THAT(text, Not(HasSubstr("hard")));
  EXPECT_THAT(text, HasSubstr("Kind standard: module 0.|Kind soft: module 1.|"));
  EXPECT_THAT(text, HasSubstr("Kind soft: modules 2, 3.|"));
}

TEST(Bill, counts_jumpers_by_length) {
  design::Design d = two_islands();
  d.layout.jumpers.push_back({{0, 1}, {0, 1}, 4.2, 0.0, design::JumperKind::kCable});
  EXPECT_THAT(sheet::bill_of(d, sheet::sides_of(d)).jumpers, ElementsAre(PieceCount{5, 1}));
}

TEST(Landmarks, are_the_corners_of_a_rectangle) {
  const auto marks = sheet::landmarks_of(flat_design("f", {0, 0}, {40, 30}).surface);
  std::set<std::pair<double, double>> corners;
  for (const auto& m : marks) corners.emplace(m.at_mm.x(), m.at_mm.y());
  for (const auto& c : corners) EXPECT_TRUE((c.first == 0 || c.first == 40) && (c.second == 0 || c.second == 30));
  ASSERT_GE(marks.size(), 2U);
  EXPECT_EQ(marks[0].name, "R1");
  EXPECT_THAT(marks[0].where, HasSubstr("+x"));
  EXPECT_TRUE(sheet::landmarks_of({}).empty());
}

TEST(Landmarks, of_a_part_without_rim_are_its_farthest_points) {
  design::Mesh tetrahedron;
  tetrahedron.vertices = {{0, 0, 0}, {50, 0, 0}, {0, 50, 0}, {0, 0, 50}};
  tetrahedron.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const auto marks = sheet::landmarks_of(tetrahedron);
  ASSERT_EQ(marks.size(), 4U);
  EXPECT_EQ(marks[0].name, "S1");
  EXPECT_EQ(marks[0].at_mm, Vec3(50, 0, 0));
}

TEST(Landmarks, two_distances_that_meet_at_a_point) {
  // R1 and R2 are in one line with the point, R3 is aside: 30, 40 and 60 mm away.
  const std::vector<sheet::Landmark> marks{{"R1", {30, 0, 0}, ""}, {"R2", {-40, 0, 0}, ""}, {"R3", {0, 60, 0}, ""}};
  const auto fix = sheet::fix_of(marks, {0, 0, 0});
  EXPECT_THAT(fix.landmark, ElementsAre(0, 2));
  EXPECT_THAT(fix.distance_mm, ElementsAre(30.0, 60.0));
}

void expect_on_paper(const sheet::IslandPage& island, const sheet::Page& page, const design::Tile& tile) {
  for (const auto& corner : island.corners_of(tile)) {
    EXPECT_GE(corner.minCoeff(), sheet::kMargin_mm) << page.title;
    EXPECT_LE(corner.x(), page.size_mm.x() - sheet::kMargin_mm) << page.title;
    EXPECT_LE(corner.y(), page.size_mm.y() - sheet::kMargin_mm - sheet::kFoot_mm) << page.title;
  }
}

// Makes forty islands, every second of one module, the others of eleven, with a controller for each.
design::Design forty_islands() {
  design::Design d = strip(240);
  d.patches.clear();
  int next = 0;
  for (int island = 0; island < 40; ++island) {
    const int size = island % 2 == 0 ? 1 : 11;
    design::Patch patch;
    patch.entry = next;
    for (int n = 0; n < size; ++n, ++next) {
      auto& m = d.layout.modules[static_cast<std::size_t>(next)];
      m.island = island;
      m.neighbour = {-1, -1, -1};
      m.tile = d.layout.modules[static_cast<std::size_t>(n)].tile;
      patch.modules.push_back({next, n == 0 ? -1 : next - 1, 2, n / 4, n % 4, n});
    }
    d.patches.push_back(patch);
  }
  d.layout.islands = 40;
  d.design_id = design::design_id_of(d);
  return d;
}

TEST(Plan, of_forty_islands_has_at_most_a_page_for_each_and_ten_more) {
  const design::Design d = forty_islands();
  const auto plan = sheet::plan_of(d, sheet::Paper::kA4);
  EXPECT_LE(plan.pages.size(), 50U);
  int ticked = 0, steps = 0;
  std::set<int> islands;
  for (const auto& page : plan.pages) {
    for (const auto& island : page.islands) {
      islands.insert(island.island);
      for (const int id : island.modules)
        expect_on_paper(island, page, d.layout.modules[static_cast<std::size_t>(id)].tile);
    }
    for (const auto& line : page.lines) {
      if (page.title == "Order of work" && line.kind == sheet::LineKind::kTickRow) ++ticked;
      if (!line.cells.empty() && line.cells[0].starts_with("1. Lay its modules")) ++steps;
    }
  }
  EXPECT_EQ(islands.size(), 40U);
  EXPECT_EQ(ticked, 40) << "a line to tick for each island";
  EXPECT_EQ(steps, 1) << "the steps stand there once";
}

// A supply of 2.8 V leaves nothing for a chain of sixteen modules at 20 mA each: the sheet says which ones need a feed.
TEST(Plan, names_the_modules_that_need_a_second_feed) {
  const design::Design d = strip(16);
  const auto lines_about_feed = [&](const design::SupplyModel& supply) {
    std::vector<std::string> found;
    for (const auto& page : sheet::plan_of(d, sheet::Paper::kA4, supply).pages) {
      for (const auto& line : page.lines) {
        if (!line.cells.empty() && line.cells[0].find("get less than") != std::string::npos)
          found.push_back(line.cells[0]);
      }
    }
    return found;
  };
  EXPECT_TRUE(lines_about_feed({}).empty()) << "by the figures of docs/routing.md there is enough";
  const auto weak = lines_about_feed({.supply_v = 3.0, .module_ma = 20.0});
  ASSERT_FALSE(weak.empty());
  EXPECT_NE(weak[0].find("2.75 V"), std::string::npos) << weak[0];
  const auto plan = sheet::plan_of(d, sheet::Paper::kA4, {.supply_v = 3.0, .module_ma = 20.0});
  const int last = d.patches.at(0).modules.back().node;
  EXPECT_LT(plan.supply_v.at(static_cast<std::size_t>(last)),
            plan.supply_v.at(static_cast<std::size_t>(d.patches[0].entry)));
}

// No two modules that share a page overlap, or are nearer than the labels around an island need.
TEST(Plan, islands_that_share_a_page_keep_their_distance) {
  const design::Design d = forty_islands();
  for (const auto& page : sheet::plan_of(d, sheet::Paper::kA4).pages) {
    for (const auto& a : page.islands) {
      for (const auto& b : page.islands) {
        if (a.island >= b.island) continue;
        double nearest_mm = 1e9;
        for (const int i : a.modules) {
          for (const auto& p : a.corners_of(d.layout.modules[static_cast<std::size_t>(i)].tile)) {
            for (const int j : b.modules) {
              for (const auto& q : b.corners_of(d.layout.modules[static_cast<std::size_t>(j)].tile))
                nearest_mm = std::min(nearest_mm, (p - q).norm());
            }
          }
        }
        EXPECT_GE(nearest_mm, 2.0 * sheet::kLabels_mm - 1e-9) << a.island << " and " << b.island;
      }
    }
  }
}

// The ruler at the right takes 8 mm within the margin, the longest caption 88 mm.
TEST(Plan, captions_of_small_islands_lie_beside_the_ruler) {
  int captions = 0;
  for (const auto& page : sheet::plan_of(forty_islands(), sheet::Paper::kA4).pages) {
    if (page.islands.size() < 2) continue;
    for (const auto& island : page.islands) {
      EXPECT_LE(island.caption_mm.x() + 88.0, page.size_mm.x() - sheet::kMargin_mm - 8.0) << page.title;
      ++captions;
    }
  }
  EXPECT_GE(captions, 20);
}

TEST(Plan, names_controllers_of_a_page_in_its_title) {
  std::vector<std::string> titles;
  for (const auto& page : sheet::plan_of(strip(20, 16), sheet::Paper::kA4).pages) titles.push_back(page.title);
  EXPECT_THAT(titles, testing::Contains("Controllers 0, 1"));
  titles.clear();
  for (const auto& page : sheet::plan_of(strip(4), sheet::Paper::kA4).pages) titles.push_back(page.title);
  EXPECT_THAT(titles, testing::Contains("Controller 0"));
}

TEST(Plan, says_to_what_radius_a_module_is_bent) {
  // By hand: a chord of 30 mm whose middle lies 4.5 mm below the arc gives a radius of 25 mm by c²/(8s); 2.25 mm give
  // 50 mm.
  EXPECT_DOUBLE_EQ(sheet::bend_radius_of_depth(4.5), 25.0);
  EXPECT_DOUBLE_EQ(sheet::bend_radius_of_depth(2.25), 50.0);
  EXPECT_TRUE(std::isinf(sheet::bend_radius_of_depth(0.0)));
  design::Design d = strip(4);
  d.layout.modules[2].edge_depth_mm = 4.0;
  d.layout.modules[3].edge_depth_mm = 2.0;
  std::string text;
  for (const auto& page : sheet::plan_of(d, sheet::Paper::kA4).pages) {
    for (const auto& line : page.lines) {
      for (const std::string& cell : line.cells) text += cell + " ";
    }
  }
  EXPECT_THAT(text, HasSubstr("Modules bent to a radius of less than 50 mm"));
  EXPECT_THAT(text, HasSubstr("2 (R 28); 1 in all"));
}

TEST(Plan, names_the_landmarks_that_the_overview_draws) {
  const auto plan = sheet::plan_of(strip(4), sheet::Paper::kA4);
  std::string text;
  for (const auto& page : plan.pages) {
    for (const auto& line : page.lines) {
      for (const std::string& cell : line.cells) text += cell + " ";
    }
  }
  ASSERT_FALSE(plan.landmarks.empty());
  EXPECT_THAT(text, HasSubstr("landmarks " + plan.landmarks.front().name + " to " + plan.landmarks.back().name));
}

TEST(Plan, has_every_module_on_one_page_and_on_the_paper) {
  for (const auto& [paper, name] : sheet::kPaperNames.rows()) {
    const design::Design d = strip(60);
    const auto plan = sheet::plan_of(d, paper);
    std::vector<int> times(60);
    for (std::size_t p = 0; p < plan.pages.size(); ++p) {
      const auto& page = plan.pages[p];
      for (const auto& island : page.islands) {
        for (const int id : island.modules) {
          ++times[static_cast<std::size_t>(id)];
          EXPECT_EQ(plan.page_of_module[static_cast<std::size_t>(id)], static_cast<int>(p) + 1);
          expect_on_paper(island, page, d.layout.modules[static_cast<std::size_t>(id)].tile);
        }
      }
    }
    EXPECT_THAT(times, testing::Each(1)) << name;
  }
}

TEST(Plan, has_a_table_for_each_controller_that_names_its_page) {
  const auto plan = sheet::plan_of(strip(20, 16), sheet::Paper::kA4);
  std::vector<int> patches;
  for (const auto& page : plan.pages) {
    for (const auto& line : page.lines) {
      if (line.patch >= 0) patches.push_back(line.patch);
    }
  }
  EXPECT_THAT(patches, ElementsAre(0, 1));
}

// The covers of a robot have the node addresses of the robot file; both places used to count them from 1.
TEST(Plan, names_the_node_addresses_that_a_robot_gives) {
  design::Design d = strip(20, 16);
  d.node_addresses = {7, 12};
  std::vector<std::string> titles, labels;
  for (const auto& page : sheet::plan_of(d, sheet::Paper::kA4).pages) {
    for (const auto& line : page.lines) {
      if (line.patch >= 0) titles.push_back(line.cells.at(0));
    }
    for (const auto& label : page.labels) labels.push_back(label.first);
  }
  EXPECT_THAT(titles, ElementsAre("Controller 0 (node address 7)", "Controller 1 (node address 12)"));
  EXPECT_THAT(labels, ElementsAre("node address 7", "node address 12"));
}

TEST(Plan, refuses_a_design_without_modules) {
  const design::Design empty = flat_design("empty", {0, 0}, {10, 10});
  EXPECT_THROW((void)sheet::plan_of(empty, sheet::Paper::kA4), InputError);
}

}  // namespace
}  // namespace triskin::test
