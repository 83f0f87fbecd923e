// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the files for iCub hosts as the hosts do. The readers below follow the public sources of the robot (skinPart of
// skinDynLib, SkinMeshThreadPort and Triangle_10pad of iCubSkinGui, facts only) and share nothing with the writer: pads
// are placed by the table with which skinGui draws.
#include "triskin/exports/icub_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <sstream>

#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/exports/skingui.hpp"

namespace triskin::test {
namespace {

using design::Vec2;
using design::Vec3;

// Holds what skinDynLib stores of a file of positions.
struct HostTaxel {
  Vec3 position_m, normal;
  int id = 0;
};
struct HostPart {
  std::string name;
  std::size_t size = 0;
  std::vector<HostTaxel> taxels;
  std::vector<int> representative;
};

HostPart read_as_skin_dyn_lib(const std::string& text) {
  HostPart part;
  std::istringstream lines(text);
  std::vector<std::array<double, 6>> group;
  bool in_group = false;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key;
    if (line.starts_with("[")) {
      in_group = line == "[calibration]";
    } else if (in_group) {
      std::array<double, 6> row{};
      for (double& value : row) words >> value;
      group.push_back(row);
    } else if (words >> key; key == "name") {
      words >> part.name;
    } else if (key == "taxel2Repr") {
      words >> key;
      for (int r = 0; words >> r;) part.representative.push_back(r);
    }
  }
  part.size = group.size();
  // The host counts from 1 and stops before its size, so the last row is never read.
  for (std::size_t i = 1; i < part.size; ++i) {
    const auto& r = group[i - 1];
    const HostTaxel taxel{{r[0], r[1], r[2]}, {r[3], r[4], r[5]}, static_cast<int>(i) - 1};
    if (taxel.position_m.norm() != 0.0 || taxel.normal.norm() != 0.0) part.taxels.push_back(taxel);
  }
  return part;
}

// These are the pads of skinGui's triangle, in its units, and where it draws them.
constexpr std::array<std::array<double, 2>, 12> kPad{{{257.2, 0},
                                                      {385.83, -222.83},
                                                      {128.62, -222.83},
                                                      {0, 0},
                                                      {-128.62, -222.83},
                                                      {-385.83, -222.83},
                                                      {-256.3, -147.64},
                                                      {-257.2, 0},
                                                      {-128.62, 222.83},
                                                      {0, 445.54},
                                                      {0, 296.55},
                                                      {128.62, 222.83}}};
struct DrawnTriangle {
  std::array<Vec2, 12> pad;
  Vec2 center;
};

std::map<int, DrawnTriangle> read_as_skin_gui(const std::string& text) {
  std::map<int, DrawnTriangle> drawn;
  std::istringstream lines(text.substr(text.find("[SENSORS]\n") + 10));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string type;
    int id = 0, mirror = 0, layout = 0;
    double x = 0, y = 0, turn_deg = 0, gain = 0;
    words >> type >> id >> x >> y >> turn_deg >> gain >> mirror >> layout;
    if (type != "triangle_10pad" || id < 0 || id >= 128 || drawn.contains(id)) continue;
    const double cosine = std::cos(turn_deg * 3.14159265358979 / 180),
                 sine = std::sin(turn_deg * 3.14159265358979 / 180);
    DrawnTriangle t{{}, {x, y}};
    for (std::size_t k = 0; k < 12; ++k) {
      const double px = (mirror == 1 ? -1 : 1) * kPad[k][0] / 40, py = kPad[k][1] / 40;
      t.pad[layout == 1 ? 11 - k : k] = {x + cosine * px - sine * py, y + sine * px + cosine * py};
    }
    drawn[id] = t;
  }
  return drawn;
}

// Makes twenty modules on two controllers, with mixed lines and addresses; module k is turned by k % 3.
design::Design mixed() {
  design::Design d = strip(20, 12);
  d.name = "left arm";
  for (auto& patch : d.patches) {
    for (std::size_t k = 0; k < patch.modules.size(); ++k) {
      patch.modules[k].line = static_cast<int>(2 - k / 4);
      patch.modules[k].address = static_cast<int>((k + 1) % 4);
      patch.modules[k].rotation = static_cast<int>(k % 3);
    }
  }
  return d;
}

TEST(IcubPositions, give_each_taxel_its_place_in_the_hosts_reader) {
  const design::Design d = mixed();
  const HostPart part = read_as_skin_dyn_lib(exports::icub_positions(d));
  EXPECT_EQ(part.name, "left_arm_6c1880ca");
  EXPECT_EQ(part.size, 2U * 16 * 12);
  ASSERT_EQ(part.representative.size(), part.size);
  std::map<int, HostTaxel> by_id;
  for (const auto& t : part.taxels) by_id[t.id] = t;
  const auto wiring = design::wiring_of(d);
  std::size_t expected = 0;
  for (std::size_t k = 0; k < wiring.size(); ++k) {
    const auto& r = wiring[k].routed;
    const int first = 12 * (16 * wiring[k].patch + 4 * r.line + r.address);
    const auto poses = design::taxels_of(d.layout.modules[k], r.rotation);
    for (int t = 0; t < 12; ++t) {
      const bool thermal = t == 6 || t == 10;
      EXPECT_EQ(part.representative[static_cast<std::size_t>(first + t)], thermal ? -1 : first + 3);
      EXPECT_EQ(by_id.contains(first + t), !thermal);
      if (thermal) continue;
      ++expected;
      EXPECT_LT((by_id[first + t].position_m * 1e3 - poses[static_cast<std::size_t>(t)].position_mm).norm(), 0.001);
      EXPECT_LT((by_id[first + t].normal - poses[static_cast<std::size_t>(t)].normal).norm(), 2e-6);
    }
  }
  EXPECT_EQ(part.taxels.size(), expected);  // Missing triangles have no taxels.
}

// The host never reads the last row of the file: a module on line 3 with address 3 of the last board would lose its
// taxel 11.
TEST(IcubPositions, lose_the_last_taxel_of_the_last_triangle_in_the_hosts_reader) {
  design::Design d = strip(1);
  d.patches[0].modules[0].line = d.patches[0].modules[0].address = 3;
  EXPECT_EQ(read_as_skin_dyn_lib(exports::icub_positions(d)).taxels.size(), 9U);
}

TEST(IcubSkinGui, draws_each_pad_where_it_lies_in_the_island) {
  const design::Design d = mixed();
  const auto drawn = read_as_skin_gui(exports::icub_skingui(d));
  ASSERT_EQ(drawn.size(), 20U);
  const auto wiring = design::wiring_of(d);
  // The strip is flat and is its own lattice, so places agree up to a shift.
  const auto number = [&](std::size_t k) {
    return 16 * wiring[k].patch + 4 * wiring[k].routed.line + wiring[k].routed.address;
  };
  const auto& corner = d.layout.modules[0].corner_mm;
  const Vec2 shift = drawn.at(number(0)).center - ((corner[0] + corner[1] + corner[2]) / 3.0).head<2>();
  for (std::size_t k = 0; k < 20; ++k) {
    const auto poses = design::taxels_of(d.layout.modules[k], wiring[k].routed.rotation);
    for (std::size_t t = 0; t < 12; ++t) {
      const Vec2 place = poses[t].position_mm.head<2>() + shift;
      // skinGui's triangle is 1.6 % smaller than the module: 0.2 mm at the outermost pad; its thermal pads lie
      // elsewhere by 0.2 mm.
      EXPECT_LT((drawn.at(number(k)).pad[t] - place).norm(), 0.3) << k << " " << t;
    }
  }
}

TEST(IcubSkinGui, is_read_by_our_own_reader_of_skingui_files_with_the_same_joints) {
  const design::Design d = mixed();
  const auto file = std::filesystem::temp_directory_path() / ("icub_files_test." + std::to_string(::getpid()) + ".ini");
  write_file_atomically(file, exports::icub_skingui(d));
  const auto layout = exports::read_skingui(file);
  std::filesystem::remove(file);
  ASSERT_EQ(layout.list.ids.size(), 20U);
  EXPECT_EQ(layout.boards, 2);
  std::size_t joints = 0;
  for (const auto& node : layout.list.graph.nodes) {
    for (const int n : node.neighbour) joints += n >= 0 ? 1 : 0;
  }
  EXPECT_EQ(joints, 2U * 19);
}

// The covers of a robot have the node addresses of the robot file; the cards used to count from 1.
TEST(IcubSkinGui, names_the_node_addresses_that_a_robot_gives) {
  design::Design d = mixed();
  d.node_addresses = {5, 9};
  EXPECT_TRUE(exports::icub_skingui(d).starts_with("cardid 5 9\n"));
}

TEST(IcubFiles, refuse_what_no_bus_has) {
  EXPECT_THROW((void)exports::icub_skingui(strip(9, 1)), InputError);  // The design has 9 · 16 triangles.
  EXPECT_NO_THROW((void)exports::icub_positions(strip(9, 1)));
  EXPECT_THROW((void)exports::icub_positions(strip(15, 1)), InputError);
  design::Design loose = strip(2, 1);
  loose.patches.pop_back();
  EXPECT_THROW((void)exports::icub_positions(loose), InputError);
}

}  // namespace
}  // namespace triskin::test
