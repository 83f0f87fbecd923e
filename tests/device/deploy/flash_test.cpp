// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/deploy/flash.hpp"

#include <gtest/gtest.h>

#include "support/device_fixture.hpp"
#include "support/temp_folder.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_table.hpp"

namespace triskin::deploy {

using test::Fixture;

namespace {

TEST(PatchTable, row_fields_follow_the_design) {
  const layout::PatchImage image = session::image_of(test::strip(6), layout::PatchIndex{0});
  EXPECT_EQ(image.module_count, 6);
  EXPECT_EQ(image.node_address, 1);
  // Module 1 is connected to module 0, whose side 1 faces it; module 0 is turned by 2, so that side is its port (1 - 2)
  // mod 3 = 2.
  EXPECT_EQ(image.modules[1].parent, 0);
  EXPECT_EQ(image.modules[1].parent_port, 2);
  EXPECT_EQ(layout::kept_ports(image)[0], 0b101);
  // Module 2 is connected to module 1 at its side 0: port (0 - 2) mod 3 = 1. The last module keeps only its input.
  EXPECT_EQ(image.modules[2].parent_port, 1);
  EXPECT_EQ(layout::kept_ports(image)[5], 0b001);
  EXPECT_EQ(image.modules[5].line, 1);
  EXPECT_EQ(image.modules[5].address, 1);
}

TEST(PatchTable, a_design_that_fits_no_table_is_refused) {
  design::Design d = test::strip(6);
  d.patches[0].modules[3].address = 2;
  EXPECT_THROW((void)session::image_of(d, layout::PatchIndex{0}), InputError);
  d = test::strip(17, 17);
  EXPECT_THROW((void)session::image_of(d, layout::PatchIndex{0}), InputError);
  d = test::strip(6);
  d.patches[0].modules[3].parent = 0;  // The module has no neighbour there.
  EXPECT_THROW((void)session::image_of(d, layout::PatchIndex{0}), InputError);
}

TEST(Flash, fresh_boards_with_one_default_address_get_one_each) {
  Fixture fixture(20, 8);
  for (const auto& c : fixture.bus().discover()) EXPECT_EQ(c.node_address, 1);
  const FlashResult r = fixture.flash();
  ASSERT_EQ(r.patches.size(), 3U);
  EXPECT_EQ(r.skipped, 0);
  EXPECT_EQ(r.bytes, (32 + 8 * 12) * 2 + 32 + 4 * 12U);
  for (int p = 0; p < 3; ++p) {
    session::Controller c(fixture.bus(), static_cast<std::uint8_t>(p + 1));
    EXPECT_EQ(c.active_table().design_id, fixture.design().design_id);
    EXPECT_EQ(c.read_table(session::bytes_of(session::image_of(fixture.design(), layout::PatchIndex{p})).size()),
              session::bytes_of(session::image_of(fixture.design(), layout::PatchIndex{p})));
  }
}

TEST(Flash, equal_tables_are_skipped_and_a_dry_run_writes_nothing) {
  Fixture fixture(20, 8);
  FlashOptions dry;
  dry.dry_run = true;
  EXPECT_EQ(fixture.flash(dry).bytes, 0U);
  EXPECT_EQ(fixture.skin().flash(0).operations(), 0U);
  fixture.flash();
  fixture.bus().listen(fixture.bus().now_us() + 2'000'000);  // The controllers find and store their offsets.
  const std::uint64_t operations = fixture.skin().flash(0).operations();
  const FlashResult again = fixture.flash();
  EXPECT_EQ(again.skipped, 3);
  EXPECT_EQ(again.bytes, 0U);
  EXPECT_EQ(fixture.flash(dry).skipped, 3);
  EXPECT_EQ(fixture.skin().flash(0).operations(), operations);
  FlashOptions force;
  force.force = true;
  EXPECT_GT(fixture.flash(force).bytes, 0U);
}

TEST(Flash, too_few_controllers_are_an_error_before_anything_is_written) {
  Fixture fixture(6);
  EXPECT_THROW((void)flash(fixture.bus(), test::strip(12, 6)), DeviceError);
  EXPECT_EQ(fixture.skin().flash(0).operations(), 0U);
}

TEST(Flash, one_patch_alone_gets_its_table_and_the_others_keep_theirs) {
  Fixture fixture(12, 4);
  fixture.flash();
  fixture.bus().listen(fixture.bus().now_us() + 2'000'000);  // The controllers find and store their offsets.
  std::array<std::uint64_t, 3> before{};
  for (std::size_t p = 0; p < 3; ++p) before.at(p) = fixture.skin().flash(p).operations();
  FlashOptions options;
  options.force = true;
  options.patch = layout::PatchIndex{2};
  const FlashResult r = fixture.flash(options);
  ASSERT_EQ(r.patches.size(), 1U);
  EXPECT_EQ(r.patches[0].patch, layout::PatchIndex{2});
  EXPECT_TRUE(r.patches[0].written);
  for (std::size_t p = 0; p < 3; ++p) {
    EXPECT_EQ(fixture.skin().flash(p).operations() > before.at(p), p == 2) << p;
  }
}

TEST(Flash, a_patch_that_the_design_does_not_have_is_refused) {
  Fixture fixture(12, 4);
  FlashOptions options;
  options.patch = layout::PatchIndex{3};
  EXPECT_INPUT_ERROR((void)fixture.flash(options), "--patch 3: the design has patches 0-2");
}

TEST(Flash, spare_controllers_make_room) {
  Fixture fixture(12, 4);  // There are three controllers, but the design below needs two.
  const design::Design two = test::strip(8, 4);
  const FlashResult r = flash(fixture.bus(), two);
  EXPECT_EQ(r.patches.size(), 2U);
  std::vector<int> addresses;
  for (const auto& c : fixture.bus().discover()) addresses.push_back(c.node_address);
  EXPECT_EQ(addresses, (std::vector<int>{1, 2, 3}));
}

TEST(Flash, an_unplugged_cable_is_a_device_error) {
  Fixture fixture(6);
  fixture.flash();
  fixture.skin().plug(false);
  EXPECT_THROW((void)fixture.flash(), DeviceError);
  fixture.skin().plug(true);
  EXPECT_EQ(fixture.flash().skipped, 1);
}

// The old table belongs to another wiring of the same modules; power fails in every flash operation while the new one
// is written.
class PowerCut : public testing::TestWithParam<hardware::FlashMemory::Tear> {};

TEST_P(PowerCut, leaves_the_old_or_the_new_table_and_flashing_again_completes) {
  design::Design old_design = test::strip(6);
  std::swap(old_design.patches[0].modules[1].address, old_design.patches[0].modules[2].address);
  old_design.design_id = design::design_id_of(old_design);
  int cuts = 0;
  for (std::uint64_t operation = 0;; ++operation) {
    Fixture fixture(6);
    (void)flash(fixture.bus(), old_design);
    fixture.skin().flash(0).cut_power_after(operation, GetParam());
    bool completed = false;
    try {
      fixture.flash();
      completed = fixture.skin().alive(0);
    } catch (const DeviceError&) {
    }
    if (completed) break;
    ++cuts;
    EXPECT_FALSE(fixture.skin().alive(0));
    fixture.skin().power_cycle(0);
    const wire::ActiveTable after = session::Controller(fixture.bus(), 1).active_table();
    ASSERT_TRUE(after.present()) << "operation " << operation;
    EXPECT_TRUE(after.design_id == old_design.design_id || after.design_id == fixture.design().design_id) << operation;
    fixture.flash();
    EXPECT_EQ(session::Controller(fixture.bus(), 1).active_table().design_id, fixture.design().design_id) << operation;
    EXPECT_TRUE(fixture.verify(false).findings.empty());
  }
  // There are one erase, 104 bytes of image and 16 of commit record in units of 8.
  EXPECT_EQ(cuts, 1 + 104 / 8 + 16 / 8);
}

INSTANTIATE_TEST_SUITE_P(Tears, PowerCut,
                         testing::Values(hardware::FlashMemory::Tear::kBefore, hardware::FlashMemory::Tear::kHalf));

TEST(FirstFlash, a_cut_in_any_operation_of_a_fresh_board_can_be_repaired) {
  for (std::uint64_t operation = 0;; ++operation) {
    Fixture fixture(20, 16);  // Patch 1 needs an address and a table.
    fixture.skin().flash(1).cut_power_after(operation, hardware::FlashMemory::Tear::kHalf);
    bool completed = false;
    try {
      fixture.flash();
      completed = fixture.skin().alive(1);
    } catch (const DeviceError&) {
    }
    if (completed) break;
    fixture.skin().power_cycle(1);
    fixture.flash();
    EXPECT_TRUE(fixture.verify(false).findings.empty()) << operation;
  }
}

}  // namespace
}  // namespace triskin::deploy
