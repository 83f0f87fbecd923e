// SPDX-License-Identifier: GPL-3.0-or-later
// Tests which controller belongs to which patch, found out before a table is written.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "joined_patches.hpp"
#include "support/random_design.hpp"
#include "support/strip_design.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/deploy/identify.hpp"
#include "triskin/diagnose/verify.hpp"
#include "triskin/hardware/sim_link.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::test {
namespace {

using deploy::BoardShape;
using deploy::FoundBy;

// Simulates a skin whose boards were never flashed and are on the bus in any order of their ids.
class FreshSkin {
 public:
  FreshSkin(const design::Design& design, bool switched, std::uint64_t seed, std::vector<hardware::Fault> faults = {},
            std::vector<hardware::Contact> contacts = {}, bool joined = false)
      : link_(scene_of(design, switched, seed, std::move(faults), std::move(contacts), joined)), bus_(link_) {}

  deploy::FlashResult flash(bool touch = false, bool recognise = true) {
    deploy::FlashOptions options;
    options.recognise = recognise;
    options.actuator = touch ? &link_ : nullptr;
    return deploy::flash(bus_, design(), options);
  }
  std::string refusal() {
    try {
      (void)flash();
    } catch (const DeviceError& e) {
      return e.what();
    }
    return {};
  }
  [[nodiscard]] const design::Design& design() { return link_.skin().scene().design; }
  [[nodiscard]] std::string serial(int patch) {
    return session::to_text(hardware::unique_id_of(link_.skin().scene(), layout::PatchIndex{patch}));
  }
  [[nodiscard]] bool right(const deploy::FlashResult& r) {
    return r.patches.size() == design().patches.size() &&
           std::ranges::all_of(r.patches, [&](const auto& p) { return p.serial == serial(p.patch); });
  }
  [[nodiscard]] session::Bus& bus() { return bus_; }
  /// Replaces the board of a patch by one that was never flashed, and powers everything for three seconds.
  void forget(std::size_t patch) {
    auto& flash = link_.skin().flash(patch);
    for (std::size_t at = 0; at < flash.size_bytes(); at += flash.page_bytes()) ASSERT_TRUE(flash.erase_page(at));
    link_.skin().power_cycle(patch);
    bus_.listen(bus_.now_us() + 3'000'000);
  }

 private:
  static hardware::Scene scene_of(const design::Design& design, bool switched, std::uint64_t seed,
                                  std::vector<hardware::Fault> faults, std::vector<hardware::Contact> contacts,
                                  bool joined) {
    hardware::Scene s;
    s.design = design;
    s.switched = switched;
    s.border_joints = joined;
    s.board_seed = seed;
    s.faults = std::move(faults);
    s.contacts = std::move(contacts);
    return s;
  }
  hardware::SimLink link_;
  session::Bus bus_;
};

// Makes two equal patches: a strip in which they repeat.
design::Design alike() {
  return strip(12, 4);
}

// Fresh boards used to get the patches in the order of their ids, so switched patches got wrong tables.
TEST(FreshBoards, switched_patches_are_recognised_by_their_shape_though_all_share_an_address) {
  std::mt19937_64 random(51);
  int wrong_by_order = 0, several = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const design::Design design = random_design(40, random);
    FreshSkin by_order(design, true, seed);
    if (!by_order.right(by_order.flash(false, false))) ++wrong_by_order;
    FreshSkin skin(design, true, seed);
    std::set<int> addresses;
    for (const auto& c : skin.bus().discover()) addresses.insert(c.node_address);
    ASSERT_EQ(addresses, std::set<int>{1});
    const auto r = skin.flash();
    EXPECT_TRUE(skin.right(r)) << seed;
    several += r.patches.size() > 2 ? 1 : 0;
    for (const auto& p : r.patches) EXPECT_EQ(p.by, FoundBy::kShape);
    EXPECT_TRUE(diagnose::verify(skin.bus(), design, {}).findings.empty()) << seed;
  }
  EXPECT_GE(several, 6);
  EXPECT_GE(wrong_by_order, 4);  // Of the 8 cases with three patches, one order in six is right by chance.
}

TEST(FreshBoards, equal_shapes_are_refused_and_no_table_is_written) {
  FreshSkin skin(alike(), true, 3);
  const std::string text = skin.refusal();
  for (const char* part : {"ambiguous", "patches 0, 1, 2", "triskin identify", "--assign 0=SERIAL"})
    EXPECT_NE(text.find(part), std::string::npos) << part << '\n' << text;
  for (int p = 0; p < 3; ++p) EXPECT_NE(text.find(skin.serial(p)), std::string::npos) << text;
  for (const auto& c : skin.bus().discover()) EXPECT_FALSE(c.has_table);
}

TEST(FreshBoards, the_finger_of_a_simulation_tells_equal_shapes_apart) {
  for (const bool switched : {false, true}) {
    FreshSkin skin(alike(), switched, 3);
    const auto r = skin.flash(true);
    EXPECT_TRUE(skin.right(r));
    for (const auto& p : r.patches) EXPECT_EQ(p.by, FoundBy::kTouch);
    EXPECT_TRUE(diagnose::verify(skin.bus(), skin.design(), {}).findings.empty());
  }
}

// A look at eighty boards takes longer than a press is waited for, and a message that named every patch for every board
// would have 30,000 characters.
TEST(FreshBoards, the_finger_of_a_simulation_tells_eighty_boards_apart) {
  const design::Design design = strip(80 * 16);
  EXPECT_LT(FreshSkin(design, false, 3).refusal().size(), 2000U);
  FreshSkin skin(design, false, 3);
  EXPECT_TRUE(skin.right(skin.flash(true)));
}

// Strapped modules show no joints, but only where chips answer. Questions are needed only for equal patches.
TEST(FreshBoards, strapped_patches_are_recognised_by_their_places) {
  FreshSkin skin(strip(10, 4), false, 5);  // The patches have 4, 4 and 2 modules.
  const std::string text = skin.refusal();
  EXPECT_NE(text.find("patches 0, 1:"), std::string::npos) << text;
  EXPECT_EQ(text.find(skin.serial(2)), std::string::npos) << text;
  const auto r = skin.flash(true);
  EXPECT_TRUE(skin.right(r));
  EXPECT_EQ(r.patches[2].by, FoundBy::kShape);
}

TEST(FreshBoards, a_broken_joint_does_not_hide_a_patch) {
  std::mt19937_64 random(52);
  int tried = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const design::Design design = random_design(40, random);
    const design::RoutedModule& last = design.patches[0].modules.back();
    hardware::Fault cut;
    cut.kind = hardware::FaultKind::kOpenJoint;
    cut.module = layout::ModuleId{last.node};
    cut.other = layout::ModuleId{last.parent};
    FreshSkin skin(design, true, seed, {cut});
    EXPECT_TRUE(skin.right(skin.flash())) << seed;
    ++tried;
  }
  EXPECT_EQ(tried, 6);
}

FreshSkin joined(const design::Design& design, std::uint64_t seed, std::vector<hardware::Fault> faults = {}) {
  return {design, true, seed, std::move(faults), {}, true};
}

// A fresh board whose patch is joined to others used to take sixteen modules of any patch and hold them, and to begin
// anew for each port behind which was a seventeenth. Some boards announced themselves after more than the 0.12 s of
// waiting, and the shapes fitted no patch.
TEST(FreshBoards, whose_patches_are_joined_all_answer_and_are_recognised) {
  std::mt19937_64 random(53);
  int by_shape = 0, all = 0, several = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const design::Design design = random_design(20 + 8 * static_cast<int>(seed), random);
    FreshSkin skin = joined(design, seed);
    ASSERT_EQ(skin.bus().discover().size(), design.patches.size()) << seed;
    const auto r = skin.flash(true);
    EXPECT_TRUE(skin.right(r)) << seed;
    EXPECT_TRUE(diagnose::verify(skin.bus(), design, {}).findings.empty()) << seed;
    several += design.patches.size() > 2 ? 1 : 0;
    all += static_cast<int>(r.patches.size());
    by_shape += static_cast<int>(std::ranges::count(r.patches, FoundBy::kShape, &deploy::FlashResult::Patch::by));
  }
  EXPECT_GE(several, 8);
  EXPECT_GE(2 * by_shape, all);
  std::printf("%d of %d joined patches recognised by their shape, the others by touch\n", by_shape, all);
}

// A board is replaced while its neighbours hold their modules.
TEST(FreshBoards, that_replaces_one_among_joined_patches_answers_and_is_recognised) {
  const design::Design design = joined_patches(8, 12);
  ASSERT_GE(design.patches.size(), 4U);
  for (std::size_t p = 0; p < design.patches.size(); ++p) {
    FreshSkin skin = joined(design, 5);
    ASSERT_TRUE(skin.right(skin.flash(true)));
    skin.forget(p);
    ASSERT_EQ(skin.bus().discover().size(), design.patches.size()) << p;
    EXPECT_TRUE(skin.right(skin.flash())) << p;
    EXPECT_TRUE(diagnose::verify(skin.bus(), design, {}).findings.empty()) << p;
  }
}

// If shapes and the finger decide nothing, the message names the remedy.
TEST(FreshBoards, of_joined_patches_that_look_alike_are_refused_by_name) {
  FreshSkin skin = joined(joined_patches(16, 12), 6);
  const std::string text = skin.refusal();
  for (const char* part : {"ambiguous", "triskin identify", "--assign"})
    EXPECT_NE(text.find(part), std::string::npos) << part << '\n' << text;
  EXPECT_TRUE(skin.right(skin.flash(true)));
  EXPECT_TRUE(diagnose::verify(skin.bus(), skin.design(), {}).findings.empty());
}

TEST(FreshBoards, a_dry_run_moves_nobody) {
  FreshSkin skin(alike(), true, 3);
  deploy::FlashOptions options;
  options.recognise = options.dry_run = true;
  for (const auto& p : deploy::flash(skin.bus(), skin.design(), options).patches) EXPECT_EQ(p.by, FoundBy::kNothing);
  for (const auto& c : skin.bus().discover()) EXPECT_EQ(c.node_address, 1);
}

BoardShape answers(std::uint8_t line0, std::uint8_t line1 = 0) {
  BoardShape s;
  s.answers = {line0, line1, 0, 0};
  return s;
}

TEST(Shapes, differ_in_the_places_where_only_one_has_a_chip) {
  const design::Design design = strip(10, 4);  // Patches 0 and 1 have line 0, addresses 0 … 3; patch 2 has 0 and 1.
  EXPECT_EQ(deploy::shape_difference(answers(0b1111), design, layout::PatchIndex{0}), 0);
  EXPECT_EQ(deploy::shape_difference(answers(0b0111), design, layout::PatchIndex{0}), 1);
  EXPECT_EQ(deploy::shape_difference(answers(0b1111, 1), design, layout::PatchIndex{0}), 1);
  EXPECT_EQ(deploy::shape_difference(answers(0b0001), design, layout::PatchIndex{0}), -1);  // Three of four answer.
  EXPECT_EQ(deploy::shape_difference(answers(0), design, layout::PatchIndex{2}), -1);
}

TEST(Shapes, settle_what_every_way_to_serve_all_patches_agrees_on) {
  const design::Design design = strip(10, 4);
  const std::vector all{layout::PatchIndex{0}, layout::PatchIndex{1}, layout::PatchIndex{2}};
  const auto settled = [&](std::vector<BoardShape> shapes) {
    return deploy::assign_by_shape(shapes, deploy::seats_of(design, all));
  };
  const auto plain = settled({answers(0b1111), answers(0b0011), answers(0b1111)});
  EXPECT_EQ(plain.seat, (std::vector<int>{-1, 2, -1}));
  EXPECT_EQ(plain.likely, (std::vector<std::vector<int>>{{0, 1}, {2}, {0, 1}}));
  // One of the patches of four has a dead chip, but is still nearest to them.
  EXPECT_EQ(settled({answers(0b1111), answers(0b0011), answers(0b1101)}).seat, (std::vector<int>{-1, 2, -1}));
  // A fourth board equals patch 2 too, so one of the two has it.
  EXPECT_EQ(settled({answers(0b1111), answers(0b0011), answers(0b1111), answers(0b0011)}).seat,
            (std::vector<int>{-1, -1, -1, -1}));
  // Nothing answers.
  EXPECT_EQ(settled({answers(0), answers(0b0011)}).seat, (std::vector<int>{-1, 2}));
}

// Patches have 4 and 3 modules: with one dead chip both boards look like the patch of three.
TEST(Shapes, do_not_settle_what_one_dead_chip_explains_otherwise) {
  const design::Design design = strip(7, 4);
  const std::vector all{layout::PatchIndex{0}, layout::PatchIndex{1}};
  const std::vector<BoardShape> doubtful{answers(0b0111), answers(0b0111)}, sound{answers(0b0111), answers(0b1111)};
  EXPECT_EQ(deploy::assign_by_shape(doubtful, deploy::seats_of(design, all)).seat, (std::vector<int>{-1, -1}));
  EXPECT_EQ(deploy::assign_by_shape(sound, deploy::seats_of(design, all)).seat, (std::vector<int>{1, 0}));
}

hardware::Contact touch_of(const design::Design& design, int module, double from_s, double until_s) {
  hardware::Contact c;
  c.from_us = static_cast<std::uint64_t>(from_s * 1e6);
  c.until_us = static_cast<std::uint64_t>(until_s * 1e6);
  c.position_mm = hardware::center_of(design, layout::ModuleId{module});
  c.radius_mm = 8.0;
  return c;
}

// Fingers come from the scene: patch 0, then a hand on two patches, then patch 1.
TEST(Identify, says_who_felt_the_finger) {
  for (const bool switched : {false, true}) {
    const design::Design design = alike();
    FreshSkin skin(
        design, switched, 7, {},
        {touch_of(design, 1, 4, 5), touch_of(design, 5, 6, 7), touch_of(design, 9, 6, 7), touch_of(design, 6, 8, 9)});
    std::vector<int> asked;
    std::vector<std::string> said;
    deploy::IdentifyOptions options;
    options.limit_s = 10.0;
    options.ask = [&](int patch) { asked.push_back(patch); };
    options.say = [&](const std::string& text) { said.push_back(text); };
    const auto boards = deploy::identify(skin.bus(), design, options);
    ASSERT_EQ(boards.size(), 3U);
    for (const auto& b : boards) EXPECT_EQ(b.serial, skin.serial(b.patch)) << b.patch;
    EXPECT_EQ(asked, (std::vector<int>{0, 1}));  // Only the third is left.
    EXPECT_EQ(boards[2].by, FoundBy::kOnly);
    ASSERT_EQ(said.size(), 1U);
    EXPECT_NE(said[0].find("two patches"), std::string::npos);
    const auto before = diagnose::verify(skin.bus(), design, {}).findings;
    ASSERT_EQ(before.size(), 1U);  // A flash that was ended leaves its boards in this state.
    EXPECT_EQ(before[0].kind, diagnose::FindingKind::kNotFlashed) << before[0].text;
    EXPECT_NE(before[0].text.find("3 of 3 controllers on the link have no table"), std::string::npos) << before[0].text;
    // Its tables belong to nobody: the design is flashed as if the boards were fresh.
    deploy::FlashOptions named;
    for (const auto& b : boards) named.assign.push_back({b.patch, b.serial});
    EXPECT_TRUE(skin.right(deploy::flash(skin.bus(), design, named)));
    EXPECT_TRUE(diagnose::verify(skin.bus(), design, {}).findings.empty());
  }
}

TEST(Identify, a_patch_that_nobody_touches_is_missing) {
  const design::Design design = alike();
  FreshSkin skin(design, false, 7, {}, {touch_of(design, 1, 4, 5)});
  deploy::IdentifyOptions options;
  options.limit_s = 5.0;
  const auto boards = deploy::identify(skin.bus(), design, options);
  ASSERT_EQ(boards.size(), 3U);
  EXPECT_EQ(boards[0].serial, skin.serial(0));
  EXPECT_EQ(boards[1].by, FoundBy::kNothing);
  EXPECT_TRUE(boards[2].serial.empty());
}

TEST(Identify, asks_for_one_patch_also_where_its_table_is_there) {
  const design::Design design = alike();
  FreshSkin skin(design, false, 9);
  ASSERT_TRUE(skin.right(skin.flash(true)));
  deploy::IdentifyOptions options;
  options.patch = layout::PatchIndex{2};
  options.actuator = link::touch_actuator_of(skin.bus().link());
  const auto boards = deploy::identify(skin.bus(), design, options);
  ASSERT_EQ(boards.size(), 1U);
  EXPECT_EQ(boards[0].serial, skin.serial(2));
  EXPECT_EQ(boards[0].by, FoundBy::kTouch);
  EXPECT_TRUE(diagnose::verify(skin.bus(), design, {}).findings.empty());  // Its tables are unchanged.
  options.patch = layout::PatchIndex{3};
  EXPECT_THROW((void)deploy::identify(skin.bus(), design, options), InputError);
}

}  // namespace
}  // namespace triskin::test
