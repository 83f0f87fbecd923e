// SPDX-License-Identifier: GPL-3.0-or-later
// Tests several covers on one bus: addresses of the robot file, boards that are left alone, one stream for all.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <deque>
#include <filesystem>
#include <map>

#include "device/robot/robots.hpp"
#include "triskin/diagnose/verify.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/stream.hpp"

namespace triskin::robot {
namespace {

using test::add_strip;
using test::bare_robot;
using test::SimulatedBus;

// The covers have controllers 1 … 3, 4 and 5, 6.
Assembly three_covers() {
  Assembly a = bare_robot(1);
  add_strip(a, "upper", 0, 12, 4);
  add_strip(a, "lower", 0, 10, 5);
  add_strip(a, "hand", 0, 3, 16);
  return a;
}

// Returns the number of a cover's first controller on the bus.
int device_number(const Site& site, std::size_t cover) {
  std::size_t number = 0;
  for (std::size_t c = 0; c < cover; ++c) number += site.buses[0].covers[c].design.patches.size();
  return static_cast<int>(number);
}

TEST(SharedBus, covers_are_flashed_one_after_the_other_whatever_the_order) {
  const Site site = site_of(three_covers());
  SimulatedBus bus(site.buses[0]);
  for (const std::size_t cover : {2U, 0U, 1U}) {
    const auto r = bus.flash(cover);
    EXPECT_EQ(r.skipped, 0);
    for (const auto& p : r.patches) EXPECT_TRUE(p.written);
  }
  const std::vector<std::uint64_t> ids{site.buses[0].covers[0].design.design_id,
                                       site.buses[0].covers[1].design.design_id,
                                       site.buses[0].covers[2].design.design_id};
  const int owner[] = {0, 0, 0, 0, 1, 1, 2};
  for (std::uint8_t node = 1; node <= 6; ++node)
    EXPECT_EQ(session::Controller(bus.bus(), node).active_table().design_id,
              ids[static_cast<std::size_t>(owner[node])]);
  for (std::size_t cover = 0; cover < 3; ++cover) EXPECT_EQ(bus.flash(cover).bytes, 0U);
}

// Fresh boards are in any order, as on a workbench, of covers with equal and with different patches: 4, 4, 4; 5, 5; 3.
TEST(SharedBus, fresh_boards_in_any_order_find_the_patch_that_they_hang_on) {
  const Site site = site_of(three_covers());
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    SimulatedBus bus(site.buses[0], {}, seed);
    deploy::FlashOptions options;
    options.recognise = true;
    for (std::size_t cover = 0; cover < 3; ++cover) {
      const CoverConfig& c = site.buses[0].covers[cover];
      link::CoverTouchActuator actuator(*link::touch_actuator_of(bus.link()), c.first_module);
      options.actuator = &actuator;
      for (const auto& p : deploy::flash(bus.bus(), c.design, flash_options(site.buses[0], c, options)).patches) {
        const auto number = static_cast<std::size_t>(device_number(site, cover) + p.patch);
        EXPECT_EQ(p.serial, session::to_text(hardware::unique_id_of(bus.skin().scene(), layout::PatchIndex{number})))
            << "seed " << seed << ", cover " << c.name << ", patch " << p.patch;
        EXPECT_EQ(p.by, cover == 2 ? deploy::FoundBy::kOnly : deploy::FoundBy::kTouch);
      }
    }
  }
}

// In one pass, boards that a cover has got are no longer available for the next, though they have no table yet.
TEST(SharedBus, all_covers_of_a_bus_are_written_in_one_pass) {
  const Site site = site_of(three_covers());
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SimulatedBus bus(site.buses[0], {}, seed);
    deploy::FlashOptions options;
    options.recognise = true;
    std::deque<link::CoverTouchActuator> actuators;
    std::deque<session::Bus> buses;
    std::vector<deploy::FlashPart> parts;
    for (const CoverConfig& c : site.buses[0].covers) {
      options.actuator = &actuators.emplace_back(*link::touch_actuator_of(bus.link()), c.first_module);
      session::Bus& own = buses.emplace_back(bus.link());
      parts.push_back({&own, &c.design, flash_options(site.buses[0], c, options), {}});
    }
    std::vector<deploy::FlashResult> results;
    deploy::flash_together(parts, results);
    ASSERT_EQ(results.size(), 3U);
    for (std::size_t cover = 0; cover < 3; ++cover) {
      for (const auto& p : results[cover].patches) {
        const auto number = static_cast<std::size_t>(device_number(site, cover) + p.patch);
        EXPECT_EQ(p.serial, session::to_text(hardware::unique_id_of(bus.skin().scene(), layout::PatchIndex{number})))
            << seed << " " << cover;
        EXPECT_TRUE(p.written);
      }
    }
    deploy::flash_together(parts, results);
    for (const auto& r : results) EXPECT_EQ(r.bytes, 0U);
  }
}

// Twelve covers have one board each, of 3 … 14 modules. Knowledge about the bus from one cover serves the next: who
// answers, and the shapes. Every cover used to ask for all of it anew, 4.03 s in all.
TEST(SharedBus, fresh_boards_are_asked_once_for_all_covers) {
  Assembly a = bare_robot(1);
  for (int k = 0; k < 12; ++k) add_strip(a, fmt::format("cover{}", k), 0, 3 + k, 16);
  const Site site = site_of(a);
  SimulatedBus bus(site.buses[0], {}, 3);
  deploy::FlashOptions options;
  options.recognise = true;
  std::vector<deploy::FlashPart> parts;
  for (const CoverConfig& c : site.buses[0].covers)
    parts.push_back({&bus.bus(), &c.design, flash_options(site.buses[0], c, options), {}});
  std::vector<deploy::FlashResult> results;
  const std::uint64_t start_us = bus.bus().now_us();
  deploy::flash_together(parts, results);
  const double seconds = static_cast<double>(bus.bus().now_us() - start_us) * 1e-6;
  for (std::size_t cover = 0; cover < parts.size(); ++cover) {
    const auto& p = results[cover].patches.at(0);
    EXPECT_EQ(p.serial, session::to_text(hardware::unique_id_of(bus.skin().scene(), layout::PatchIndex{cover})));
    EXPECT_TRUE(p.written);
  }
  EXPECT_LT(seconds, 1.0);
  std::printf("12 covers of a fresh bus: %.2f s of bus time\n", seconds);
}

// The hand's board is dead, but the robot file knows the boards of the others, which get their tables.
TEST(SharedBus, a_cover_without_its_board_leaves_the_others_their_tables) {
  Assembly a = three_covers();
  int n = 0;
  for (CoverEntry& cover : a.robot.covers) {
    for (ControllerEntry& e : cover.controllers) e.serial = fmt::format("{:024X}", 0xABC0 + n++);
  }
  const Site site = site_of(a);
  SimulatedBus bus(site.buses[0]);
  bus.skin().on_delivery([](std::size_t p, const wire::CanFrame&) { return p != 1; });
  std::vector<deploy::FlashPart> parts;
  for (const CoverConfig& c : site.buses[0].covers)
    parts.push_back({&bus.bus(), &c.design, flash_options(site.buses[0], c, {}), {}});
  std::vector<deploy::FlashResult> results;
  std::string said;
  try {
    deploy::flash_together(parts, results);
  } catch (const DeviceError& e) {
    said = e.what();
  }
  EXPECT_NE(said.find("upper, patch 1: sim: no controller 00000000000000000000ABC1 answers"), std::string::npos)
      << said;
  EXPECT_NE(
      said.find("upper: 2 of 3 controllers have their table (patches 0, 2), the others their old one; lower: 2 of "
                "2 controllers"),
      std::string::npos)
      << said;
  const auto tables = bus.bus().discover();
  EXPECT_EQ(std::ranges::count(tables, true, &wire::NodeClaim::has_table), 5);
}

// On a real bus nothing presses: patches that shapes do not decide are refused, even if the other cover has the equal
// patch.
TEST(SharedBus, fresh_boards_that_could_be_of_two_covers_are_refused_without_a_touch) {
  Assembly a = bare_robot(1);
  add_strip(a, "left", 0, 4, 4);
  add_strip(a, "right", 0, 4, 4);
  add_strip(a, "hand", 0, 3, 16);
  const Site site = site_of(a);
  SimulatedBus bus(site.buses[0], {}, 7);
  deploy::FlashOptions options;
  options.recognise = true;
  EXPECT_THROW((void)bus.flash(0, options), DeviceError);
  EXPECT_THROW((void)bus.flash(1, options), DeviceError);
  const auto hand = bus.flash(2, options).patches.at(0);
  EXPECT_EQ(hand.by, deploy::FoundBy::kShape);
  EXPECT_EQ(hand.serial, session::to_text(hardware::unique_id_of(bus.skin().scene(), layout::PatchIndex{2})));
  for (const auto& claim : bus.bus().discover()) EXPECT_EQ(claim.has_table, claim.node_address == 3);
}

TEST(SharedBus, every_cover_verifies_with_its_own_modules) {
  const Site site = site_of(three_covers());
  SimulatedBus bus(site.buses[0]);
  for (std::size_t cover = 0; cover < 3; ++cover) (void)bus.flash(cover);
  bus.settle();
  diagnose::VerifyOptions options;
  options.touch = true;
  options.watch_s = 0.5;
  for (const CoverConfig& cover : site.buses[0].covers) {
    link::CoverTouchActuator actuator(*link::touch_actuator_of(bus.link()), cover.first_module);
    options.actuator = &actuator;
    const auto r = diagnose::verify(bus.bus(), cover.design, options);
    EXPECT_TRUE(r.findings.empty()) << cover.name << ": " << r.findings.front().text;
    EXPECT_EQ(r.touched, static_cast<int>(cover.design.layout.modules.size()));
    EXPECT_EQ(r.modules_ok, r.modules);
  }
  // Without its own count of modules a cover would take a touch on its neighbour for its own.
  options.actuator = link::touch_actuator_of(bus.link());
  EXPECT_FALSE(diagnose::verify(bus.bus(), site.buses[0].covers[1].design, options).findings.empty());
}

TEST(SharedBus, one_stream_reads_all_covers_and_knows_each_account) {
  const Site site = site_of(three_covers());
  SimulatedBus bus(site.buses[0]);
  for (std::size_t cover = 0; cover < 3; ++cover) (void)bus.flash(cover);
  std::vector<const design::Design*> covers;
  for (const CoverConfig& c : site.buses[0].covers) covers.push_back(&c.design);
  std::map<std::pair<int, int>, int> heard;
  session::Stream stream(bus.bus(), covers, [&](const session::ModuleSample& f) { ++heard[{f.cover, f.module}]; });
  stream.run_until(bus.bus().now_us() + 1'000'000);
  stream.finish();
  EXPECT_EQ(heard.size(), 25U);
  EXPECT_TRUE(stream.report().complete());
  EXPECT_EQ(stream.report().modules.size(), 25U);
  EXPECT_EQ(stream.report(layout::CoverIndex{1}).modules.size(), 10U);
  EXPECT_EQ(stream.report(layout::CoverIndex{2}).modules.size(), 3U);
  // All 25 modules share one budget: 1.04 · 25 · 317.5 / 36,900.
  EXPECT_NEAR(stream.budget().full, 0.224, 0.001);
}

// A lease is for all that receive it: a reader of one cover makes the others stream as well. With 245 modules on one
// bus, the reader of 123 of them used to take every second sample, which is 110 % of the bus, and a tenth found no
// room.
TEST(SharedBus, the_budget_of_one_cover_counts_the_others) {
  Assembly a = bare_robot(1);
  add_strip(a, "near", 0, 64, 16);
  add_strip(a, "far", 0, 80, 16);
  const Site site = site_of(a);
  SimulatedBus bus(site.buses[0]);
  for (std::size_t cover = 0; cover < 2; ++cover) (void)bus.flash(cover);
  bus.settle();
  const std::array streamed{&site.buses[0].covers[0].design};
  session::Stream stream(bus.bus(), streamed, {}, stream_options(site.buses[0], streamed, {}));
  EXPECT_EQ(stream.budget().every, 2);  // 144 modules are 129 % of the bus, while 64 alone were 57 %.
  stream.run_until(bus.bus().now_us() + 1'000'000);
  stream.finish();
  EXPECT_TRUE(stream.report().complete());
  EXPECT_EQ(stream.report().modules.size(), 64U);
}

// A cover is replaced by one of another design, with its own boards; the other boards are not written.
TEST(SharedBus, a_replaced_cover_leaves_the_other_boards_as_they_are) {
  const auto folder = std::filesystem::temp_directory_path() / ("shared_bus." + std::to_string(::getpid()));
  std::filesystem::remove_all(folder);
  Assembly a = three_covers();
  {
    const Site site = site_of(a);
    SimulatedBus bus(site.buses[0], folder);
    for (std::size_t cover = 0; cover < 3; ++cover) (void)bus.flash(cover);
    bus.settle();
  }
  a.designs[1] = test::strip(12, 4);  // There are three controllers instead of two.
  seat(a.robot, a.robot.covers[1], a.designs[1]);
  const Site site = site_of(a);
  SimulatedBus bus(site.buses[0], folder);
  bus.settle();
  const auto before = bus.operations();
  for (std::size_t cover = 0; cover < 3; ++cover) (void)bus.flash(cover);
  bus.settle();
  const auto after = bus.operations();
  for (const std::size_t node : {1U, 2U, 3U, 6U}) EXPECT_EQ(after[node], before[node]) << "node address " << node;
  for (const std::size_t node : {4U, 5U, 7U}) EXPECT_GT(after[node], before[node]) << "node address " << node;
  std::filesystem::remove_all(folder);
}

// The same boards get a new design: they hold the table of the old one, and only their names in the robot file, or the
// option, confirm that this is intended.
TEST(SharedBus, boards_of_a_changed_design_are_written_when_the_file_names_them) {
  Assembly a = three_covers();
  int n = 0;
  for (CoverEntry& cover : a.robot.covers) {
    for (ControllerEntry& e : cover.controllers) e.serial = fmt::format("{:024X}", 0xABC0 + n++);
  }
  const auto folder = std::filesystem::temp_directory_path() / ("changed_design." + std::to_string(::getpid()));
  std::filesystem::remove_all(folder);
  {
    const Site site = site_of(a);
    SimulatedBus bus(site.buses[0], folder);
    for (std::size_t cover = 0; cover < 3; ++cover) (void)bus.flash(cover);
    bus.settle();
  }
  a.designs[1] = test::strip(8, 4);
  seat(a.robot, a.robot.covers[1], a.designs[1]);
  Assembly nameless = a;
  for (ControllerEntry& e : nameless.robot.covers[1].controllers) e.serial.clear();
  const Site site = site_of(a), nameless_site = site_of(nameless);
  SimulatedBus bus(site.buses[0], folder);
  bus.settle();
  const auto before = bus.operations();
  const CoverConfig& unnamed = nameless_site.buses[0].covers[1];
  EXPECT_THROW((void)deploy::flash(bus.bus(), unnamed.design, flash_options(nameless_site.buses[0], unnamed, {})),
               DeviceError);
  EXPECT_EQ(bus.operations(), before);
  EXPECT_EQ(bus.flash(1).bytes > 0, true);
  bus.settle();
  const auto after = bus.operations();
  for (const std::size_t node : {1U, 2U, 3U, 6U}) EXPECT_EQ(after[node], before[node]) << "node address " << node;
  for (const std::size_t node : {4U, 5U}) EXPECT_GT(after[node], before[node]) << "node address " << node;
  std::filesystem::remove_all(folder);
}

// Two covers of one design are on one bus, and the address tells them apart.
TEST(SharedBus, equal_designs_are_told_apart_by_their_addresses) {
  Assembly a = bare_robot(1);
  add_strip(a, "left", 0, 8, 4);
  add_strip(a, "right", 0, 8, 4);
  const Site site = site_of(a);
  SimulatedBus bus(site.buses[0]);
  (void)bus.flash(0);
  (void)bus.flash(1);
  bus.settle();
  const auto before = bus.operations();
  EXPECT_EQ(bus.flash(1).skipped, 2);
  EXPECT_EQ(bus.flash(0).skipped, 2);
  EXPECT_EQ(bus.operations(), before);
}

// Boards that were flashed by the design file alone have addresses 1 and 2; the robot file gives them 5 and 6.
TEST(SharedBus, boards_flashed_without_a_robot_file_move_to_their_addresses) {
  Assembly a = bare_robot(1);
  add_strip(a, "arm", 0, 8, 4);
  const auto folder = std::filesystem::temp_directory_path() / ("moved_boards." + std::to_string(::getpid()));
  std::filesystem::remove_all(folder);
  for (ControllerEntry& e : a.robot.covers[0].controllers) e.serial = fmt::format("{:024X}", 0xABC0 + e.patch);
  const Site named = site_of(a);
  {
    SimulatedBus bus(named.buses[0], folder);
    (void)deploy::flash(bus.bus(), test::strip(8, 4));
  }
  for (ControllerEntry& e : a.robot.covers[0].controllers) e.node = layout::NodeAddress{e.node + 4};
  const Site moved = site_of(a);
  SimulatedBus bus(moved.buses[0], folder);
  deploy::FlashOptions nameless;  // The serial numbers are not given: the tables say which patch a board serves.
  const auto r = deploy::flash(bus.bus(), moved.buses[0].covers[0].design, nameless);
  ASSERT_EQ(r.patches.size(), 2U);
  for (const auto& p : r.patches) {
    EXPECT_EQ(p.old_address, p.patch + 1);
    EXPECT_EQ(p.address, p.patch + 5);
    EXPECT_EQ(p.serial, fmt::format("{:024X}", 0xABC0 + p.patch));
  }
  EXPECT_EQ(bus.flash(0).skipped, 2);
  std::filesystem::remove_all(folder);
}

TEST(SharedBus, a_cover_may_hang_on_two_buses) {
  Assembly a = bare_robot(2);
  add_strip(a, "back", 0, 12, 4);
  a.robot.covers[0].controllers[2].bus = "bus1";
  a.robot.covers[0].controllers[2].node = layout::NodeAddress{1};
  const Site site = site_of(a);
  ASSERT_EQ(site.buses.size(), 2U);
  int modules = 0;
  for (const BusConfig& entry : site.buses) {
    SimulatedBus bus(entry);
    EXPECT_EQ(bus.flash(0).patches.size(), entry.number == 0 ? 2U : 1U);
    bus.settle();
    diagnose::VerifyOptions options;
    options.touch = true;
    options.actuator = link::touch_actuator_of(bus.link());
    options.watch_s = 0.5;
    const auto r = diagnose::verify(bus.bus(), entry.covers[0].design, options);
    EXPECT_TRUE(r.findings.empty()) << r.findings.front().text;
    EXPECT_EQ(r.modules_ok, r.modules);
    modules += r.modules;
  }
  EXPECT_EQ(modules, 12);
}

}  // namespace
}  // namespace triskin::robot
