// SPDX-License-Identifier: GPL-3.0-or-later
// Compares flat islands, copper of the module, parts and solids with numbers worked by hand and with other readers.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "output/fabrication/src/bend.hpp"
#include "output/fabrication/src/kicad.hpp"
#include "output/fabrication/src/module_board.hpp"
#include "output/fabrication/src/module_tracks.hpp"
#include "output/fabrication/src/parts_list.hpp"
#include "output/fabrication/src/solids.hpp"
#include "support/flat_design.hpp"
#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/cad/read_part.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/design/design_text.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/fabrication/fabricate.hpp"
#include "triskin/mesh/mesh_io.hpp"

namespace triskin::fabrication {
namespace {

namespace fs = std::filesystem;
using design::Design;
using design::Tile;
using design::Vec2;
using design::Vec3;

FlatIsland only_island(const Design& d, double relief_mm = kCornerRelief_mm) {
  const auto islands = flat_islands(d, sheet::sides_of(d), relief_mm);
  EXPECT_EQ(islands.size(), 1U);
  return islands.front();
}

double length_of(const std::vector<Vec2>& ring) {
  double sum = 0.0;
  for (std::size_t k = 0; k < ring.size(); ++k) sum += (ring[(k + 1) % ring.size()] - ring[k]).norm();
  return sum;
}
double area_of(const std::vector<Vec2>& ring) {
  double twice = 0.0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2.0;
}

// Makes the six triangles around grid vertex (1, 1).
Design hexagon() {
  Design d = test::flat_design("hexagon", {0, 0}, {100, 60});
  const std::vector<Tile> tiles{{1, 1, true}, {0, 1, false}, {0, 1, true}, {0, 0, false}, {1, 0, true}, {1, 0, false}};
  std::map<Tile, int> number;
  for (const Tile& t : tiles) number.emplace(t, static_cast<int>(number.size()));
  test::lay_modules(d, tiles, number);
  return d;
}

class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("fabrication." + std::to_string(::getpid()))) { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { fs::remove_all(path_); }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// A rhombus of two modules has four sides of 30 mm; with 1 mm cut from each corner of both, 4 · 28 mm and 6 · 1 mm
// remain.
TEST(FlatIsland, RhombusHasTheOutlineWorkedByHand) {
  const FlatIsland island = only_island(test::strip(2));
  EXPECT_NEAR(length_of(island.outline_mm), 4 * 28.0 + 6 * 1.0, 1e-9);
  EXPECT_NEAR(area_of(island.outline_mm), 2 * design::module_area_mm2(1.0), 1e-9);
  EXPECT_TRUE(island.holes_mm.empty());
  ASSERT_EQ(island.folds.size(), 1U);
  EXPECT_NEAR((island.folds[0].to_mm - island.folds[0].from_mm).norm(), 28.0, 1e-9);
  EXPECT_TRUE(island.folds[0].carries_lines);
}

TEST(FlatIsland, SixFoldsMeetInAHoleOfSixShortSides) {
  const FlatIsland island = only_island(hexagon(), 2.0);
  ASSERT_EQ(island.holes_mm.size(), 1U);
  EXPECT_EQ(island.holes_mm[0].size(), 6U);
  EXPECT_NEAR(length_of(island.holes_mm[0]), 6 * 2.0, 1e-9);
  EXPECT_LT(area_of(island.holes_mm[0]), 0.0);
  EXPECT_EQ(island.folds.size(), 6U);
  EXPECT_NEAR(area_of(island.outline_mm) + area_of(island.holes_mm[0]), 6 * design::module_area_mm2(2.0), 1e-9);
}

TEST(FlatIsland, ModulesSideBySideThatAreNotJoinedHaveASlit) {
  Design d = hexagon();
  d.layout.modules[0].neighbour = {-1, -1, -1};
  for (auto& m : d.layout.modules) {
    for (int& n : m.neighbour) n = n == 0 ? -1 : n;
  }
  const FlatIsland island = only_island(d);
  EXPECT_EQ(island.folds.size(), 4U);
  EXPECT_EQ(island.slits.size(), 2U);
}

TEST(FlatIsland, RefusesWhatCannotBeCut) {
  const Design d = test::strip(2);
  EXPECT_THROW((void)flat_islands(d, sheet::sides_of(d), 0.0), InputError);
  EXPECT_THROW((void)flat_islands(d, sheet::sides_of(d), 3.5), InputError);
  const Design none = test::flat_design("none", {0, 0}, {9, 9});
  EXPECT_THROW((void)flat_islands(none, sheet::sides_of(none)), InputError);
}

// Converter inputs and pads must be those that the software assumes: 12 taxels, two of which measure temperature.
TEST(ModuleBoard, HasThePadsOfTheSoftware) {
  std::map<std::string, int> count;
  int temperature = 0;
  for (const ModulePad& pad : module_pads()) {
    ++count[pad.name];
    temperature += pad.layer == PadLayer::kTouch && pad.size_mm.x() == kTemperaturePad_mm;
  }
  EXPECT_EQ(temperature, 2);
  for (int t = 0; t < layout::kTaxelsPerModule; ++t) EXPECT_EQ(count[fmt::format("T{}", t)], 1) << t;
  for (const char port : {'A', 'B', 'C'}) {
    for (int k = 1; k <= 10; ++k) EXPECT_EQ(count[fmt::format("{}{}", port, k)], 2);
  }
}

// The pins as another board with this chip has them (opendous AD7147-1 Capacitive Touch Sensor, its net list of 2010).
TEST(ModuleBoard, ChipHasThePinsOfAnotherBoard) {
  const std::map<int, std::string_view> wanted{{7, "CIN12"}, {8, "ACSHIELD"}, {9, "BIAS"}, {10, "GND"},
                                               {11, "VCC"},  {12, "VDRIVE"},  {13, "SDA"}, {14, "ADD0"},
                                               {15, "SCLK"}, {16, "ADD1"},    {17, "INT"}, {18, "GPIO"}};
  for (const auto& [pin, name] : wanted) EXPECT_EQ(chip_pins().at(static_cast<std::size_t>(pin - 1)), name) << pin;
  for (int k = 0; k < 13; ++k) {
    const int pin = k < 6 ? 19 + k : k - 5;  // CIN0 … CIN5 are pins 19 … 24, CIN6 … CIN12 pins 1 … 7.
    EXPECT_EQ(chip_pins().at(static_cast<std::size_t>(pin - 1)), fmt::format("CIN{}", k));
  }
}

TEST(ModuleBoard, PlatedHolesStayClearOfTheTaxels) {
  for (const ModulePad& hole : module_pads()) {
    if (hole.layer != PadLayer::kThrough) continue;
    for (const ModulePad& taxel : module_pads()) {
      if (taxel.layer != PadLayer::kTouch) continue;
      EXPECT_GT((hole.at_mm - taxel.at_mm).norm(), (hole.size_mm.x() + taxel.size_mm.x()) / 2.0 + kClearance_mm)
          << hole.name << ' ' << taxel.name;
    }
  }
}

double to_segment_mm(const Vec2& p, const Vec2& a, const Vec2& b) {
  const double square = (b - a).squaredNorm();
  const double t = square > 0.0 ? std::clamp((p - a).dot(b - a) / square, 0.0, 1.0) : 0.0;
  return (p - a - t * (b - a)).norm();
}
// The tracks are short, so places 0.02 mm apart represent them.
std::vector<Vec2> places_on(const ModuleTrack& t) {
  const int parts = static_cast<int>((t.to_mm - t.from_mm).norm() / 0.02) + 1;
  std::vector<Vec2> places;
  for (int k = 0; k <= parts; ++k)
    places.emplace_back(t.from_mm + static_cast<double>(k) / parts * (t.to_mm - t.from_mm));
  return places;
}

// Whatever the corner cut, tracks and holes keep off the rings of the bus and off the edge.
TEST(ModuleBoard, InnerTracksKeepOffRingsAndEdge) {
  constexpr double kHalf_mm = kNarrowTrack_mm / 2.0, kVia_mm = kContactPad_mm / 2.0, kSlack_mm = 1e-3;
  ASSERT_FALSE(module_routing().tracks.empty());
  ASSERT_FALSE(module_routing().vias.empty());
  for (const double cut_mm : {0.1, 1.0, 3.4, kMaxBoardCornerCut_mm}) {
    const auto ring_gap_mm = [cut_mm](const Vec2& p) {
      double least = 1e9;
      for (std::size_t net = 0; net < kBusNets; ++net) {
        const auto ring = ring_of(net, cut_mm);
        for (std::size_t k = 0; k < ring.size(); ++k)
          least = std::min(least, to_segment_mm(p, ring[k], ring[(k + 1) % ring.size()]) - ring_track_mm(net) / 2.0);
      }
      return least;
    };
    for (const ModuleVia& via : module_routing().vias)
      EXPECT_GE(ring_gap_mm(via.at_mm), kVia_mm + kClearance_mm - kSlack_mm) << via.pad;
    for (const ModuleTrack& t : module_routing().tracks) {
      for (const Vec2& p : places_on(t)) {
        if (t.layer == CopperLayer::kInner2) {
          ASSERT_GE(ring_gap_mm(p), kHalf_mm + kClearance_mm - kSlack_mm) << t.pad;
        }
        const double to_short_side_mm = design::short_side_offset_mm(cut_mm) - p.norm();
        ASSERT_GE(to_short_side_mm, kHalf_mm + kEdgeClearance_mm - kSlack_mm) << t.pad;
      }
    }
  }
}

// On each layer, tracks and holes of two nets keep the clearance from each other.
TEST(ModuleBoard, InnerTracksKeepOffEachOther) {
  struct Piece {
    std::string net;
    int layer;  // −1 for all of them.
    Vec2 from_mm, to_mm;
    double radius_mm;
  };
  std::vector<Piece> pieces;
  std::map<std::string, std::string> net_of_pad;
  for (const ModulePad& pad : module_pads()) net_of_pad[pad.name] = net_of(pad, {});
  for (const ModuleTrack& t : module_routing().tracks)
    pieces.push_back({net_of_pad.at(t.pad), static_cast<int>(t.layer), t.from_mm, t.to_mm, kNarrowTrack_mm / 2.0});
  for (const ModuleVia& v : module_routing().vias)
    pieces.push_back({net_of_pad.at(v.pad), -1, v.at_mm, v.at_mm, kContactPad_mm / 2.0});
  for (const Piece& p : pieces) {
    const std::vector<Vec2> places = places_on({"", CopperLayer::kBack, p.from_mm, p.to_mm});
    for (const Piece& q : pieces) {
      if (p.net == q.net || (p.layer >= 0 && q.layer >= 0 && p.layer != q.layer)) continue;
      for (const Vec2& place : places) {
        const double gap_mm = to_segment_mm(place, q.from_mm, q.to_mm) - p.radius_mm - q.radius_mm;
        ASSERT_GE(gap_mm, kClearance_mm - 1e-3) << p.net << ' ' << q.net;
      }
    }
  }
}

// Across a shared side any port fits any other: the contact at +x of one faces that at −x of its neighbour.
TEST(ModuleBoard, EveryPortFitsEveryOther) {
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      for (std::size_t net = 0; net < kBusNets; ++net) {
        const double turn_a = 2 * std::numbers::pi / 3 * static_cast<double>(a);
        const double turn_b = 2 * std::numbers::pi / 3 * static_cast<double>(b);
        const Vec2 mine = Eigen::Rotation2Dd(-turn_a) * contact_at(a, net, 1);
        const Vec2 other = Eigen::Rotation2Dd(-turn_b) * contact_at(b, net, -1);
        const double inradius_mm = design::kHeight_mm / 3;
        // The neighbour is turned by 180° about the middle of the side.
        const Vec2 across(-other.x(), -2 * inradius_mm - other.y());
        EXPECT_NEAR(mine.x(), across.x(), 1e-9);
        EXPECT_NEAR(mine.y() + inradius_mm, -(across.y() + inradius_mm), 1e-9);
      }
    }
  }
}

// Address 2 is ADD1 high, ADD0 low (AD7147 data sheet); line 3 closes SDA3 and SCL3.
TEST(ModuleBoard, StrapsSetLineAndAddress) {
  const ModuleSetting setting{design::ModuleNumber{7}, layout::PatchIndex{1}, 3, 2};
  std::set<std::string> closed;
  for (const Strap& strap : straps()) {
    if (is_closed(strap, setting)) closed.insert(strap.name);
  }
  EXPECT_EQ(closed, (std::set<std::string>{"SDA3", "SCL3", "ADD0L", "ADD1H"}));
  const auto net = [&](const char* name) { return net_of({name, PadLayer::kBack, {}, {}, 0}, setting); };
  EXPECT_EQ(net("U1.13"), "P1_SDA3");
  EXPECT_EQ(net("U1.15"), "P1_SCL3");
  EXPECT_EQ(net("U1.14"), "P1_GND");
  EXPECT_EQ(net("U1.16"), "P1_VDD");
  EXPECT_EQ(net("U1.19"), "M7_CIN0");
  EXPECT_EQ(net("SDA1.1"), "P1_SDA1");
  EXPECT_EQ(net("SDA1.2"), "P1_SDA3");
}

TEST(Boards, RefuseACornerCutThatTakesPads) {
  Design d = test::strip(2);
  d.layout.corner_cut_mm = 5.0;
  const auto sides = sheet::sides_of(d);
  EXPECT_THROW((void)island_board(d, sides, flat_islands(d, sides)[0]), InputError);
}

// By hand: the board has 0.272 mm, so the middle of a bend has a radius of 2.72 + 0.136 = 2.856 mm; taxels begin 3.0
// - 1.75 = 1.25 mm from a side, and the outermost hole's wall is 1.85 - 0.1 - 0.5 = 1.25 mm from where its bend may
// end. Half of the arc is 1.25 mm at 2 · 1.25 / 2.856 = 0.875 rad, 50°.
TEST(Bends, TheModuleAllowsFiftyDegrees) {
  EXPECT_NEAR(bend_reach_mm(1.0), 2.856 / 2.0, 1e-12);
  EXPECT_NEAR(module_bend_limit_rad(), 0.875, 0.002);
  // The outermost lane of a cable lies 0.4 mm from the side and is 0.1 mm wide.
  EXPECT_NEAR(cable_bend_limit_rad(), 2.0 * 0.35 / 2.856, 1e-9);
}

// Modules 0 and 1 of a strip, the second one turned up about their common side from (30, 0) to (15, 26).
Design bent_pair(double angle_rad) {
  Design d = test::strip(2);
  auto& corner = d.layout.modules[1].corner_mm;
  const Vec3 from(30, 0, 0), axis = (Vec3(15, design::kHeight_mm, 0) - from).normalized();
  for (Vec3& p : corner) p = from + Eigen::AngleAxisd(angle_rad, axis) * (p - from);
  return d;
}
TEST(Bends, ASharpJointIsRefusedByName) {
  const double limit_rad = module_bend_limit_rad();
  for (const double sign : {-1.0, 1.0}) {
    const Design just = bent_pair(sign * (limit_rad - 0.01)), sharp = bent_pair(sign * (limit_rad + 0.01));
    EXPECT_NO_THROW(require_bends(just, sheet::sides_of(just), only_island(just)));
    try {
      require_bends(sharp, sheet::sides_of(sharp), only_island(sharp));
      FAIL() << "a joint of " << sign * (limit_rad + 0.01) << " rad was taken";
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("modules 0 and 1"), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("--fold-rad 0.87"), std::string::npos) << e.what();
    }
  }
}

// `check` has a formula of its own, from the taxels of the file.
TEST(Bends, CheckNamesTheJointsThatAreRefused) {
  int refused = 0, taken = 0;
  for (int entry_side = 0; entry_side < 3; ++entry_side) {
    for (int step = -24; step <= 24; ++step) {
      Design d = bent_pair(0.05 * step);
      for (auto& m : d.patches.front().modules) {
        if (m.parent < 0) m.rotation = entry_side;
      }
      bool is_refused = false;
      try {
        require_bends(d, sheet::sides_of(d), only_island(d));
      } catch (const InputError&) {
        is_refused = true;
      }
      EXPECT_EQ(!check::check_design_text(design::design_text(d), "pair").sharp_joints.empty(), is_refused)
          << 0.05 * step << " rad, entry at side " << entry_side;
      ++(is_refused ? refused : taken);
    }
  }
  EXPECT_GT(refused, 0);
  EXPECT_GT(taken, 0);
}

TEST(Fabricate, LeavesBoardsOutWhereAJointIsTooSharp) {
  const Folder folder;
  const Design d = bent_pair(1.0);
  const std::set<Product> boards{Product::kKicad};
  EXPECT_THROW((void)fabricate(d, folder.path() / "kicad", {boards, 1.0, 2.0, 2.0}), InputError);
  const auto report = fabricate(d, folder.path() / "all", {{}, 1.0, 2.0, 2.0});
  ASSERT_FALSE(report.left_out.empty());
  EXPECT_NE(report.left_out.front().find("the boards are left out"), std::string::npos) << report.left_out.front();
  EXPECT_FALSE(fs::exists(folder.path() / "all/kicad"));
  EXPECT_FALSE(fs::exists(folder.path() / "all/order"));
  EXPECT_TRUE(fs::exists(folder.path() / "all/sheets"));
}

TEST(PartsList, CountsWhatAStripNeeds) {
  const Design d = test::strip(20);
  const auto sides = sheet::sides_of(d);
  std::map<std::string, int> count;
  for (const PartLine& line : parts_of(d, sides, flat_islands(d, sides))) count[line.part_number] += line.quantity;
  EXPECT_EQ(count["AD7147ACPZ-1500RL7"], 20);
  EXPECT_EQ(count["GRM155R71C104KA88D"], 20);
  EXPECT_EQ(count["STM32G474RET6"], 2);
}

TEST(PartsList, QuotesFieldsAsCsvWants) {
  EXPECT_EQ(parts_csv({{"a, b", 2, "", "", "say \"x\""}}),
            "part,quantity,manufacturer,part_number,note\r\n\"a, b\",2,,,\"say \"\"x\"\"\"\r\n");
}

design::Mesh plate() {
  return test::flat_design("plate", {0, 0}, {40, 30}).surface;
}

TEST(Layer, OfAPlateIsExact) {
  const Layer layer = layer_of(plate(), 2.0, 5.0);
  EXPECT_NEAR(volume_mm3(layer.solid.mesh), 40 * 30 * 3.0, 1e-9);
  EXPECT_NEAR(layer.error_mm, 0.0, 1e-12);
  EXPECT_EQ(layer.folded_faces, 0);
}

// The faces of a roof of 135° meet at the ridge under equal angles: the ridge moves by 1 / cos 22.5°, so that both
// planes are at the right distance.
TEST(Layer, OfARoofIsExact) {
  design::Mesh roof;
  roof.vertices = {{0, 0, 0}, {30, 0, 0}, {30, 10, 10}, {0, 10, 10}, {30, 30, 10}, {0, 30, 10}};
  roof.faces = {{0, 1, 2}, {0, 2, 3}, {3, 2, 4}, {3, 4, 5}};
  const Layer layer = layer_of(roof, 0.0, 4.0);
  EXPECT_NEAR(layer.error_mm, 0.0, 1e-12);
  const Vec3& ridge = layer.solid.mesh.vertices[6 + 2];
  EXPECT_NEAR((ridge - roof.vertices[2]).norm(), 4.0 / std::cos(std::numbers::pi / 8), 1e-12);
}

// On random heights over a grid, the stated error is the largest that a test of every vertex and plane finds.
TEST(Layer, StatesItsLargestError) {
  std::mt19937_64 random(3);
  constexpr int kSize = 8;
  design::Mesh hills;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x)
      hills.vertices.push_back({10.0 * x, 10.0 * y, static_cast<double>(random() % 1000) / 200.0});
  }
  for (int y = 0; y + 1 < kSize; ++y) {
    for (int x = 0; x + 1 < kSize; ++x) {
      const int a = y * kSize + x, c = a + kSize + 1;
      hills.faces.push_back({a, a + 1, c});
      hills.faces.push_back({a, c, a + kSize});
    }
  }
  const Layer layer = layer_of(hills, -1.0, 2.0);
  double worst_mm = 0.0;
  for (const auto& face : hills.faces) {
    const auto at = [&](std::size_t k) { return hills.vertices[static_cast<std::size_t>(face[k])]; };
    const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    for (const int v : face) {
      const auto low = static_cast<std::size_t>(v), high = low + hills.vertices.size();
      worst_mm = std::max(worst_mm, std::abs(normal.dot(layer.solid.mesh.vertices[low] - at(0)) + 1.0));
      worst_mm = std::max(worst_mm, std::abs(normal.dot(layer.solid.mesh.vertices[high] - at(0)) - 2.0));
    }
  }
  EXPECT_GT(worst_mm, 0.01);
  EXPECT_NEAR(layer.error_mm, worst_mm, 1e-9);
}

// Inside a half cylinder of radius 5 mm, an offset of 6 mm inwards turns its faces over, except for the first and last
// strip, whose edge at the rim moves along their own normal and not to the axis.
TEST(Layer, SaysWhereItFoldsOverItself) {
  design::Mesh groove;
  constexpr int kSteps = 12;
  for (int k = 0; k <= kSteps; ++k) {
    const double angle = std::numbers::pi * (1.0 + static_cast<double>(k) / kSteps);
    for (const double x : {0.0, 40.0}) groove.vertices.push_back({x, 5 * std::cos(angle), 5 * std::sin(angle)});
  }
  for (int k = 0; k < kSteps; ++k) {
    groove.faces.push_back({2 * k, 2 * k + 1, 2 * k + 3});
    groove.faces.push_back({2 * k, 2 * k + 3, 2 * k + 2});
  }
  EXPECT_EQ(layer_of(groove, 0.0, 4.0).folded_faces, 0);
  EXPECT_EQ(layer_of(groove, 0.0, 6.0).folded_faces, 2 * (kSteps - 2));
}

TEST(Layer, RefusesNothingAndNoThickness) {
  EXPECT_THROW((void)layer_of({}, 0.0, 1.0), InputError);
  EXPECT_THROW((void)layer_of(plate(), 1.0, 1.0), InputError);
}

TEST(Fabricate, SolidsAreReadBackWithTheirVolume) {
  const Folder folder;
  const Design d = test::strip(6);
  const auto report = fabricate(d, folder.path(), {{Product::kSolids}, 1.0, 2.0, 3.0});
  EXPECT_EQ(report.files.size(), 4U);
  const double modules_mm3 = 6 * design::module_area_mm2(1.0) * kBoard_mm;
  const double plate_mm3 = 1001.0 * 31.0 * 3.0;  // strip() has this surface.
  const auto volume = [&](const char* name) { return volume_mm3(mesh::read_mesh(folder.path() / name).mesh); };
  EXPECT_NEAR(volume("solids/modules.stl") / modules_mm3, 1.0, 1e-4);  // The file has single precision.
  EXPECT_NEAR(volume("solids/carrier.stl") / plate_mm3, 1.0, 1e-4);
  EXPECT_NEAR(volume("solids/mould.stl") / plate_mm3, 1.0, 1e-4);
  EXPECT_NEAR(volume("solids/solids.3mf") / (modules_mm3 + 2 * plate_mm3), 1.0, 1e-6);
}

TEST(Fabricate, AssemblyIsReadBackWithNamesColoursAndVolumes) {
  if (!cad::can_read_parts()) GTEST_SKIP() << "left out: built without the program for CAD files";
  const Folder folder;
  const Design d = test::strip(5);
  (void)fabricate(d, folder.path(), {{Product::kStep}, 1.0, 2.0, 2.0});
  const cad::Part part = cad::read_part(folder.path() / "strip.step");
  EXPECT_TRUE(part.faults.empty()) << part.faults.front();
  ASSERT_EQ(part.bodies.size(), 6U);
  std::set<std::string> names;
  for (const auto& body : part.bodies) {
    names.insert(body.name);
    EXPECT_EQ(body.is_solid, body.name != "cover") << body.name;
    EXPECT_FALSE(body.colour.empty()) << body.name;
  }
  EXPECT_EQ(names, (std::set<std::string>{"cover", "M0", "M1", "M2", "M3", "M4"}));
  EXPECT_NEAR(part.unit_mm, 1.0, 1e-12);
}

// A build without the geometry kernel writes everything else and reports the gap; a request for STEP alone gets the
// reason.
TEST(Fabricate, SaysSoWithoutTheProgramForCadFiles) {
  const char* before = std::getenv("TRISKIN_CAD_READER");
  const std::string named = before == nullptr ? "" : before;
  ::setenv("TRISKIN_CAD_READER", "/nowhere/triskin-cad", 1);
  const Folder folder;
  const auto report = fabricate(test::strip(2), folder.path() / "all", {{}, 1.0, 2.0, 2.0});
  EXPECT_EQ(report.left_out.size(), 1U);
  EXPECT_FALSE(fs::exists(folder.path() / "all/strip.step"));
  EXPECT_TRUE(fs::exists(folder.path() / "all/parts.csv"));
  EXPECT_THROW((void)fabricate(test::strip(2), folder.path() / "step", {{Product::kStep}, 1.0, 2.0, 2.0}), InputError);
  before == nullptr ? ::unsetenv("TRISKIN_CAD_READER") : ::setenv("TRISKIN_CAD_READER", named.c_str(), 1);
}

TEST(Fabricate, WritesAllOrNothing) {
  const Folder folder;
  Design d = test::strip(3);
  d.layout.corner_cut_mm = 5.0;  // No board can be made with this cut.
  EXPECT_THROW((void)fabricate(d, folder.path(), {{Product::kDxf, Product::kKicad}, 1.0, 2.0, 2.0}), InputError);
  EXPECT_FALSE(fs::exists(folder.path()));
  (void)fabricate(d, folder.path(), {{Product::kDxf}, 1.0, 2.0, 2.0});
  try {
    (void)fabricate(d, folder.path(), {{Product::kDxf}, 1.0, 2.0, 2.0});
    FAIL() << "files of another design were mixed with these";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("has files in it already"), std::string::npos) << e.what();
  }
}

TEST(Fabricate, EqualDesignsGiveEqualBytes) {
  const Folder folder;
  const Design d = test::strip(4);
  const std::set<Product> products{Product::kDxf, Product::kKicad, Product::kParts, Product::kSolids};
  const auto first = fabricate(d, folder.path() / "1", {products, 1.0, 2.0, 2.0});
  const auto second = fabricate(d, folder.path() / "2", {products, 1.0, 2.0, 2.0});
  ASSERT_EQ(first.files, second.files);
  for (const std::string& name : first.files)
    EXPECT_EQ(read_file(folder.path() / "1" / name), read_file(folder.path() / "2" / name)) << name;
}

TEST(Fabricate, RefusesThicknessesOutOfRange) {
  const Folder folder;
  EXPECT_THROW((void)fabricate(test::strip(2), folder.path(), {{}, 1.0, 0.0, 2.0}), InputError);
  EXPECT_THROW((void)fabricate(test::strip(2), folder.path(), {{}, 1.0, 2.0, 21.0}), InputError);
  EXPECT_FALSE(fs::exists(folder.path()));
}

TEST(Fabricate, NamesOfDesignsMayHoldAnything) {
  EXPECT_TRUE(plain_name("../a b\"c").starts_with(".._a_b_c_"));
  EXPECT_EQ(plain_name("../a b"), ".._a_b_8332e407");
  EXPECT_EQ(plain_name(""), "design");
}

}  // namespace
}  // namespace triskin::fabrication
