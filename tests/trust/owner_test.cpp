// SPDX-License-Identifier: GPL-3.0-or-later
// A controller belongs to the design whose table it holds.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "shared_skin.hpp"
#include "triskin/diagnose/verify.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::deploy {
namespace {

using test::SharedSkin;
using test::strip;
using test::strip_scene;

class Owners : public testing::Test {
 protected:
  deploy::FlashResult flash(const design::Design& design, const deploy::FlashOptions& options = {}) {
    return deploy::flash(bus_, design, options);
  }
  std::string refusal(const design::Design& design, const deploy::FlashOptions& options = {}) {
    try {
      (void)flash(design, options);
    } catch (const DeviceError& e) {
      return e.what();
    }
    return {};
  }
  [[nodiscard]] std::string serial(std::size_t k) { return session::to_text(bus_.discover().at(k).unique_id); }
  [[nodiscard]] std::uint64_t operations() {
    std::uint64_t n = 0;
    for (std::size_t p = 0; p < hub_.skin().controllers(); ++p) n += hub_.skin().flash(p).operations();
    return n;
  }

  SharedSkin hub_{strip_scene(12, 4)};  // There are three controllers.
  SharedSkin::Client link_{hub_};
  session::Bus bus_{link_};
};

// A flash with another design used to take the controllers silently, and the first design's verify then found 5 of 96
// modules.
TEST_F(Owners, another_design_is_left_alone) {
  (void)flash(hub_.design());
  // After a new table the controllers search the offsets of their converters, about 1 s, and store them in flash.
  bus_.listen(bus_.now_us() + 3'000'000);
  const std::uint64_t before = operations();
  bus_.listen(bus_.now_us() + 1'000'000);
  ASSERT_EQ(operations(), before);  // The boards write nothing by themselves any more.
  const std::string text = refusal(strip(8, 4));
  EXPECT_NE(text.find("--take-over"), std::string::npos) << text;
  EXPECT_NE(text.find(serial(0)), std::string::npos) << text;
  EXPECT_NE(text.find(fmt::format("{:016x}", hub_.design().design_id)), std::string::npos) << text;
  EXPECT_EQ(operations(), before);
  EXPECT_TRUE(diagnose::verify(bus_, hub_.design(), {}).findings.empty());
}

TEST_F(Owners, taking_over_is_said_by_the_caller) {
  (void)flash(hub_.design());
  deploy::FlashOptions options;
  options.take_over = true;
  EXPECT_EQ(flash(strip(8, 4), options).patches.size(), 2U);
  EXPECT_EQ(session::Controller(bus_, 1).active_table().design_id, strip(8, 4).design_id);
}

TEST_F(Owners, a_named_controller_gets_its_patch_whatever_it_holds) {
  deploy::FlashOptions options;
  options.assign = {
      {layout::PatchIndex{0}, serial(2)}, {layout::PatchIndex{1}, serial(0)}, {layout::PatchIndex{2}, serial(1)}};
  const deploy::FlashResult r = flash(hub_.design(), options);
  for (const auto& a : options.assign) EXPECT_EQ(r.patches.at(static_cast<std::size_t>(a.patch)).serial, a.serial);
  // The controllers keep the assignment, so a second flash finds every table equal.
  EXPECT_EQ(flash(hub_.design()).skipped, 3);
}

TEST_F(Owners, one_board_at_a_time) {
  deploy::FlashOptions options;
  options.patch = layout::PatchIndex{1};
  const std::string text = refusal(hub_.design(), options);
  EXPECT_NE(text.find("--assign 1=SERIAL"), std::string::npos) << text;
  options.assign = {{layout::PatchIndex{1}, serial(2)}};
  const deploy::FlashResult r = flash(hub_.design(), options);
  ASSERT_EQ(r.patches.size(), 1U);
  EXPECT_EQ(r.patches[0].patch, 1);
  EXPECT_EQ(session::Controller(bus_, 2).active_table().modules, 4);
  // With one board left for each patch, nothing has to be named.
  for (std::size_t k = 0; k < 2; ++k) {
    options.patch = layout::PatchIndex{k == 0 ? 0 : 2};
    options.assign = {{options.patch, serial(k)}};
    (void)flash(hub_.design(), options);
  }
  EXPECT_EQ(flash(hub_.design()).skipped, 3);
}

TEST_F(Owners, a_board_alone_on_the_bus_needs_no_name) {
  SharedSkin single(strip_scene(4, 4));
  SharedSkin::Client link(single);
  session::Bus bus(link);
  const design::Design whole = strip(12, 4);
  deploy::FlashOptions options;
  options.patch = layout::PatchIndex{2};
  const deploy::FlashResult r = deploy::flash(bus, whole, options);
  ASSERT_EQ(r.patches.size(), 1U);
  EXPECT_EQ(session::Controller(bus, 3).active_table().design_id, whole.design_id);
}

TEST_F(Owners, a_name_that_cannot_be_is_refused) {
  deploy::FlashOptions options;
  options.assign = {{layout::PatchIndex{3}, serial(0)}};
  EXPECT_THROW((void)flash(hub_.design(), options), InputError);
  options.assign = {{layout::PatchIndex{0}, serial(0)}, {layout::PatchIndex{1}, serial(0)}};
  EXPECT_THROW((void)flash(hub_.design(), options), InputError);
  options.assign = {{layout::PatchIndex{0}, "000000000000000000000000"}};
  EXPECT_THROW((void)flash(hub_.design(), options), DeviceError);
  options = {};
  options.patch = layout::PatchIndex{3};
  EXPECT_THROW((void)flash(hub_.design(), options), InputError);
  EXPECT_EQ(operations(), 0U);
}

}  // namespace
}  // namespace triskin::deploy
