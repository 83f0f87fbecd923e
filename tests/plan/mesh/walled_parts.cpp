// SPDX-License-Identifier: GPL-3.0-or-later
#include "walled_parts.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include "block_solid.hpp"
#include "shell_solid.hpp"

namespace triskin::testing {
namespace {

using design::Vec3;
using std::numbers::pi;

constexpr double kWall_mm = 2.0;

BlockSolid::Bend straight() {
  return [](const Vec3& p) { return p; };
}
BlockSolid::Bend moved(const Vec3& by, const BlockSolid::Bend& bend = straight()) {
  return [by, bend](const Vec3& p) { return Vec3(bend(p) + by); };
}
// x runs around an axis along y; z = 0 lies at the radius.
BlockSolid::Bend round_y(double radius) {
  return [radius](const Vec3& p) {
    const double r = radius + p.z(), a = p.x() / radius;
    return Vec3(r * std::sin(a), p.y(), r * std::cos(a));
  };
}
BlockSolid::Bend turned_over(const Vec3& by) {
  return [by](const Vec3& p) { return Vec3(p.x() + by.x(), by.y() - p.y(), by.z() - p.z()); };
}
BlockSolid::Bend dome(double radius) {
  return [radius](const Vec3& p) {
    const Vec3 d = Vec3(std::tan(p.x() / radius), std::tan(p.y() / radius), 1.0).normalized();
    return Vec3((radius + p.z()) * d);
  };
}

// The plate is as thick as the wall under z = 0: its top is outside, and letters may be cut into it by 1 mm.
BlockSolid::SideRule top_is_outer(const Vec3& low, const Vec3& high) {
  return [low, high](const Vec3& m, const Vec3& n) {
    if (n.z() > 0.5) return m.z() > -1.01 ? 1 : -1;
    if (n.z() < -0.5) return m.z() > -kWall_mm - 1e-6 - 4.0 && m.z() < -1.0 ? -1 : 0;
    const bool is_edge =
        m.x() < low.x() + 1e-6 || m.x() > high.x() - 1e-6 || m.y() < low.y() + 1e-6 || m.y() > high.y() - 1e-6;
    return is_edge || m.z() > -kWall_mm ? 0 : -1;
  };
}
// A box without a bottom has five outside planes.
BlockSolid::SideRule box_is_outer(const Vec3& low, const Vec3& high) {
  return [low, high](const Vec3& m, const Vec3& n) {
    if (n.z() < -0.5 && m.z() < low.z() + 1e-6) return 0;
    if (n.z() > 0.5) return m.z() > -1.01 ? 1 : -1;
    for (int axis = 0; axis < 2; ++axis) {
      if (std::abs(n[axis]) < 0.5) continue;
      if (m[axis] < low[axis] + 1e-6 || m[axis] > high[axis] - 1e-6) return 1;
    }
    return n.z() < -0.5 || m.z() < -kWall_mm - 1e-6 ? -1 : 0;
  };
}

BlockSolid tray(const Vec3& size, double wall, double step = 1e9) {
  BlockSolid b(step);
  b.add({0, 0, -size.z()}, {size.x(), size.y(), 0});
  b.cut({wall, wall, -size.z() - 1.0}, {size.x() - wall, size.y() - wall, -wall});
  return b;
}
BlockSolid plate(const Vec3& size, double step = 1e9, double period = 0.0) {
  BlockSolid b(step, period);
  b.add({0, 0, -size.z()}, {size.x(), size.y(), 0});
  return b;
}
void add_ribs(BlockSolid& b, const Vec3& low, const Vec3& high, double pitch, double thickness) {
  for (double x = low.x() + pitch; x < high.x() - 1.0; x += pitch)
    b.add({x, low.y(), low.z()}, {x + thickness, high.y(), high.z()});
  for (double y = low.y() + pitch; y < high.y() - 1.0; y += pitch)
    b.add({low.x(), y, low.z()}, {high.x(), y + thickness, high.z()});
}
void add_boss(BlockSolid& b, double x, double y, double low, double high) {
  b.add({x - 4, y - 4, low}, {x + 4, y + 4, high});
  b.cut({x - 1.5, y - 1.5, low - 1}, {x + 1.5, y + 1.5, high});
}
// The three strokes of an E are 12 mm high.
void engrave(BlockSolid& b, double x, double y, double depth) {
  b.cut({x, y, -depth}, {x + 2, y + 12, 1});
  for (const double up : {0.0, 5.0, 10.0}) b.cut({x, y + up, -depth}, {x + 8, y + up + 2, 1});
}

WalledPart named(const char* name, SideTruth truth = SideTruth::kTold) {
  WalledPart p;
  p.name = name;
  p.truth = truth;
  return p;
}

WalledPart box_part(const char* name, const BlockSolid& b, const Vec3& size, SideTruth truth = SideTruth::kTold) {
  WalledPart p = named(name, truth);
  b.append_to(p, straight(), box_is_outer({0, 0, -size.z()}, {size.x(), size.y(), 0}));
  return p;
}
WalledPart plate_part(const char* name, const BlockSolid& b, const Vec3& size, const BlockSolid::Bend& bend,
                      SideTruth truth = SideTruth::kTold) {
  WalledPart p = named(name, truth);
  b.append_to(p, bend, top_is_outer({0, 0, -size.z()}, {size.x(), size.y(), 0}));
  return p;
}
WalledPart shell_part(const char* name, const ShellSolid& s, SideTruth truth = SideTruth::kTold) {
  WalledPart p = named(name, truth);
  s.append_to(p);
  return p;
}
std::function<double(double, double)> even(double wall_mm) {
  return [wall_mm](double, double) { return wall_mm; };
}

void add_trays(std::vector<WalledPart>& parts) {
  parts.push_back(box_part("tray", tray({160, 120, 25}, 2), {160, 120, 25}));
  parts.push_back(box_part("shallow_tray", tray({200, 150, 6}, 2, 5), {200, 150, 6}));
  parts.push_back(box_part("thick_box", tray({140, 110, 70}, 5), {140, 110, 70}));
  BlockSolid ribbed = tray({180, 120, 30}, 2, 6);
  add_ribs(ribbed, {2, 2, -12}, {178, 118, -2}, 29, 1.5);
  for (const double x : {45.0, 135.0}) add_boss(ribbed, x, 60, -22, -2);
  parts.push_back(box_part("ribs_and_bosses", ribbed, {180, 120, 30}));
  BlockSolid engraved = tray({150, 100, 20}, 2);
  for (int k = 0; k < 8; ++k) engrave(engraved, 20 + 13 * k, 40, 0.6);
  parts.push_back(box_part("engraved_tray", engraved, {150, 100, 20}));
  BlockSolid comb = tray({150, 110, 22}, 2);
  add_ribs(comb, {2, 2, -18}, {148, 108, -2}, 12, 1.2);
  parts.push_back(box_part("honeycomb", comb, {150, 110, 22}));
}

void add_boxes(std::vector<WalledPart>& parts) {
  WalledPart box = box_part("box_with_lid", tray({150, 110, 60}, 2), {150, 110, 60});
  BlockSolid lid = plate({150, 110, 2});
  lid.add({2.2, 2.2, 0}, {147.8, 107.8, 3});
  lid.cut({4.2, 4.2, 0}, {145.8, 105.8, 4});
  lid.append_to(box, moved({0, 0, -60.2}),
                [](const Vec3& m, const Vec3& n) { return n.z() < -0.5 ? 1 : (n.z() > 0.5 && m.z() < 0.1 ? -1 : 0); });
  parts.push_back(box);
  WalledPart two = box_part("two_part_shell", tray({120, 90, 30}, 2), {120, 90, 30});
  tray({120, 90, 30}, 2).append_to(two, turned_over({0, 90, -60.4}), box_is_outer({0, 0, -30}, {120, 90, 0}));
  parts.push_back(two);
  WalledPart apart = box_part("two_trays_side_by_side", tray({90, 80, 25}, 2), {90, 80, 25});
  tray({90, 80, 25}, 2).append_to(apart, moved({100, 0, 0}), box_is_outer({0, 0, -25}, {90, 80, 0}));
  parts.push_back(apart);
}

void add_bent_plates(std::vector<WalledPart>& parts) {
  const double around = 2.0 * pi * 45.0;
  parts.push_back(plate_part("ring", plate({around, 40, kWall_mm}, 5, around), {around, 40, kWall_mm}, round_y(45)));
  BlockSolid half = plate({150, 120, kWall_mm}, 4);
  add_ribs(half, {0, 0, -9}, {150, 120, -kWall_mm}, 37, 1.5);
  parts.push_back(plate_part("half_shell_with_ribs", half, {150, 120, kWall_mm}, round_y(48)));
  BlockSolid holes = plate({160, 110, kWall_mm}, 4);
  for (const double x : {15.0, 75.0, 145.0}) {
    for (const double y : {15.0, 95.0}) holes.cut({x - 2, y - 2, -3}, {x + 2, y + 2, 1});
  }
  holes.cut({60, 45, -3}, {95, 70, 1});
  parts.push_back(plate_part("half_shell_with_holes", holes, {160, 110, kWall_mm}, round_y(55)));
  BlockSolid cap = plate({120, 120, kWall_mm}, 4);
  for (int k = 0; k < 4; ++k) engrave(cap, 30 + 14 * k, 50, 0.5);
  add_boss(cap, 25, 25, -14, -kWall_mm);
  add_boss(cap, 95, 95, -14, -kWall_mm);
  parts.push_back(plate_part("engraved_dome", cap, {120, 120, kWall_mm}, moved({0, 0, 0}, dome(110))));
  BlockSolid ribbed = plate({150, 100, kWall_mm}, 6);
  add_ribs(ribbed, {10, 10, -8}, {140, 90, -kWall_mm}, 30, 1.5);
  parts.push_back(plate_part("flat_lid_with_ribs", ribbed, {150, 100, kWall_mm}, straight()));
  parts.push_back(
      plate_part("flat_lid", plate({150, 100, kWall_mm}, 6), {150, 100, kWall_mm}, straight(), SideTruth::kAlike));
  BlockSolid pierced = plate({120, 90, 3}, 6);
  for (const double x : {10.0, 60.0, 110.0}) pierced.cut({x - 2, 43, -4}, {x + 2, 47, 1});
  parts.push_back(plate_part("flat_lid_with_holes", pierced, {120, 90, 3}, straight(), SideTruth::kAlike));
}

void add_shells(std::vector<WalledPart>& parts) {
  ShellSolid cap;
  cap.wall_mm = even(2.5);
  cap.rim_facets = 8;
  cap.sheet = [](double u, double v) { return Vec3(dome(80)({(u - 0.5) * 130, (v - 0.5) * 130, 0})); };
  parts.push_back(shell_part("round_rimmed_cap", cap));
  cap.wall_mm = [](double u, double) { return 1.0 + 3.0 * u; };
  parts.push_back(shell_part("uneven_wall", cap));
  cap.wall_mm = even(2.0);
  cap.sheet = [](double u, double v) { return Vec3(dome(500)({(u - 0.5) * 200, (v - 0.5) * 150, 0})); };
  parts.push_back(shell_part("nearly_flat_lid", cap));
  cap.sheet = [](double u, double v) {  // A shin guard is round across and hollow along.
    const double a = (u - 0.5) * 2.4, y = (v - 0.5) * 220, r = 40 + 25 * std::pow(2 * v - 1, 2);
    return Vec3(r * std::sin(a), y, r * std::cos(a));
  };
  parts.push_back(shell_part("shin_guard", cap));
  cap.wall_mm = even(1.2);
  cap.sheet = [](double u, double v) {  // The cap is a cone of 220°.
    const double a = (u - 0.5) * 3.8, r = 30 + 35 * v;
    return Vec3(r * std::sin(a), 130 * v, r * std::cos(a));
  };
  parts.push_back(shell_part("open_cone", cap));
  cap.wall_mm = even(2.0);
  cap.sheet = [](double u, double v) { return Vec3(180 * u, 120 * v, 14 * std::sin(2 * pi * u)); };
  parts.push_back(shell_part("wave", cap, SideTruth::kAlike));
  cap.wraps = true;
  cap.rim_facets = 6;
  cap.sheet = [](double u, double v) {
    const double a = 2 * pi * u, r = 38 + 6 * std::sin(pi * v);
    return Vec3(r * std::sin(a), 90 * v, r * std::cos(a));
  };
  parts.push_back(shell_part("barrel", cap));
}

// A hat has a crown, a wall and a brim that points outwards, whose top is outside too.
void add_hat(std::vector<WalledPart>& parts) {
  BlockSolid hat = tray({130, 100, 30}, 2, 6);
  hat.add({-14, -14, -30}, {144, 114, -28});
  hat.cut({2, 2, -31}, {128, 98, -2});
  WalledPart p = named("hat");
  hat.append_to(p, straight(), [](const Vec3& m, const Vec3& n) {
    if (m.x() < -13.9 || m.x() > 143.9 || m.y() < -13.9 || m.y() > 113.9) return 0;
    if (n.z() > 0.5) return 1;
    if (n.z() < -0.5) return -1;
    return m.x() < 1 || m.x() > 129 || m.y() < 1 || m.y() > 99 ? 1 : -1;
  });
  parts.push_back(p);
}

// A board and a motor lie in a deep tray as two parts of the assembly, and neither of them is outside.
void add_board_in_tray(std::vector<WalledPart>& parts) {
  WalledPart p = box_part("board_in_tray", tray({130, 100, 45}, 2), {130, 100, 45});
  const auto all_inside = [](const Vec3&, const Vec3&) { return -1; };
  plate({112, 82, 1.6}, 6).append_to(p, moved({9, 9, -22}), all_inside);
  plate({30, 30, 14}).append_to(p, moved({50, 35, -26}), all_inside);
  parts.push_back(p);
}

// A flat panel bulges in its middle: judged by the rim alone, the flat side is the outer one; judged by the bulge, it
// is the inner one.
void add_bulged_panel(std::vector<WalledPart>& parts) {
  BlockSolid panel = plate({150, 120, 2}, 6);
  panel.add({50, 40, -2}, {100, 80, 16});
  panel.cut({52, 42, -3}, {98, 78, 14});
  WalledPart p = named("bulged_panel");
  panel.append_to(p, straight(), [](const Vec3& m, const Vec3& n) {
    if (n.z() > 0.5) return 1;
    if (n.z() < -0.5) return -1;
    if (m.x() < 1 || m.x() > 149 || m.y() < 1 || m.y() > 119) return 0;
    return m.x() < 51 || m.x() > 99 || m.y() < 41 || m.y() > 79 ? 1 : -1;
  });
  parts.push_back(p);
}

// What a scanner sees: one sheet, rough, with no other side.
void add_scans(std::vector<WalledPart>& parts) {
  std::mt19937 dice(7);
  std::normal_distribution<double> rough(0.0, 0.08);
  WalledPart scan = named("scan", SideTruth::kNoWall);
  constexpr int kRows = 90;
  for (int i = 0; i <= kRows; ++i) {
    for (int j = 0; j <= kRows; ++j) {
      const double a = (i - kRows / 2) * 0.03, y = 2.0 * j;
      const double r = 55 + 5 * std::sin(0.05 * y) + rough(dice);
      scan.mesh.vertices.emplace_back(r * std::sin(a), y, r * std::cos(a));
    }
  }
  for (int i = 0; i < kRows; ++i) {
    for (int j = 0; j < kRows; ++j) {
      const int a = i * (kRows + 1) + j, b = a + kRows + 1;
      scan.mesh.faces.push_back({a, b, b + 1});
      scan.mesh.faces.push_back({a, b + 1, a + 1});
      scan.side.insert(scan.side.end(), 2, 1);
    }
  }
  parts.push_back(scan);
  WalledPart walled = parts.front();
  for (const WalledPart& p : parts) {
    if (p.name == "round_rimmed_cap") walled = p;
  }
  walled.name = "rough_cap";
  for (Vec3& v : walled.mesh.vertices) v += Vec3(rough(dice), rough(dice), rough(dice));
  parts.push_back(walled);
  WalledPart block = plate_part("solid_block", plate({80, 60, 40}, 8), {80, 60, 40}, straight(), SideTruth::kNoWall);
  parts.push_back(block);
}

}  // namespace

std::vector<WalledPart> walled_parts() {
  std::vector<WalledPart> parts;
  add_trays(parts);
  add_boxes(parts);
  add_bent_plates(parts);
  add_shells(parts);
  add_hat(parts);
  add_board_in_tray(parts);
  add_bulged_panel(parts);
  add_scans(parts);
  return parts;
}

}  // namespace triskin::testing
