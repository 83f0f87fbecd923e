// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the tables of all boards of a bus in one pass, on a bus with realistic times and boards that erase for 22 ms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "device/deploy/firmware_file.hpp"
#include "support/device_fixture.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_table.hpp"

namespace triskin::deploy {

using test::taking_over;

namespace {

using testing::HasSubstr;
using testing::Not;

/// Makes fresh boards with 16 modules each on one bus with 1 and 2 Mbit/s, or classic with 1 Mbit/s.
class Boards {
 public:
  explicit Boards(int boards, bool fd = true) {
    hardware::Scene scene;
    scene.design = test::strip(16 * boards);
    scene.effects.bus_bit_rate = 1'000'000;
    scene.effects.bus_data_bit_rate = 2'000'000;
    link_ = std::make_unique<hardware::SimLink>(std::move(scene));
    if (!fd) skin().use_fd(false);
    bus_ = std::make_unique<session::Bus>(*link_);
  }
  [[nodiscard]] const design::Design& design() const { return link_->skin().scene().design; }
  [[nodiscard]] hardware::VirtualSkin& skin() { return link_->skin(); }
  [[nodiscard]] session::Bus& bus() { return *bus_; }
  FlashResult flash(const FlashOptions& options = taking_over()) { return deploy::flash(*bus_, design(), options); }
  /// Returns the same wiring with two modules exchanged: another design for the same boards.
  [[nodiscard]] design::Design other() const {
    design::Design d = design();
    for (auto& patch : d.patches) std::swap(patch.modules[1].address, patch.modules[2].address);
    d.design_id = design::design_id_of(d);
    return d;
  }
  [[nodiscard]] bool holds(std::size_t patch, const design::Design& design) {
    const auto image = session::bytes_of(session::image_of(design, layout::PatchIndex{patch}));
    session::Controller c(*bus_, static_cast<std::uint8_t>(patch + 1));
    return c.active_table().crc == crc32(image) && c.read_table(image.size()) == image;
  }

 private:
  std::unique_ptr<hardware::SimLink> link_;
  std::unique_ptr<session::Bus> bus_;
};

struct Cost {
  double seconds = 0.0, busy_s = 0.0;
  std::uint64_t frames = 0;
};
/// Writes all tables anew over tables of another design, after which every board has to erase.
Cost rewrite(Boards& boards, int per_wire) {
  (void)flash(boards.bus(), boards.other(), taking_over());
  boards.bus().listen(boards.bus().now_us() + 1'000'000);
  FlashOptions options = taking_over();
  options.per_wire = per_wire;
  const std::uint64_t busy_us = boards.skin().bus_busy_us(), frames = boards.skin().bus_frames();
  const FlashResult r = boards.flash(options);
  const Cost cost{r.link_s, static_cast<double>(boards.skin().bus_busy_us() - busy_us) * 1e-6,
                  boards.skin().bus_frames() - frames};
  EXPECT_EQ(r.skipped, 0);
  for (std::size_t p = 0; p < boards.design().patches.size(); ++p) EXPECT_TRUE(boards.holds(p, boards.design())) << p;
  return cost;
}

TEST(TablePass, sixteen_boards_take_the_time_of_the_wire_and_little_more) {
  for (const bool fd : {true, false}) {
    Boards one_by_one(16, fd), together(16, fd);
    const Cost before = rewrite(one_by_one, 1), now = rewrite(together, FlashOptions{}.per_wire);
    std::printf("16 boards, %s: %.3f s one after the other, %.3f s in one pass; the wire is busy %.3f s\n",
                fd ? "FD" : "classic", before.seconds, now.seconds, now.busy_s);
    EXPECT_EQ(now.frames, before.frames) << "a request was repeated";
    // The time includes twice 60 ms of waiting for claims, the erases of a slot and of a page of faults, and the wire.
    EXPECT_LT(now.seconds, 0.12 + 2 * 0.023 + now.busy_s + 0.02);
    EXPECT_GT(before.seconds, 0.12 + 16 * 0.022);
  }
}

// 161 boards are on eight buses, each with its own time; the bus with 21 boards decides.
TEST(TablePass, the_boards_of_a_robot_take_the_time_of_its_longest_bus) {
  double slow_s = 0.0, fast_s = 0.0;
  for (const int n : {20, 21}) {
    Boards one_by_one(n), together(n);
    slow_s = std::max(slow_s, rewrite(one_by_one, 1).seconds);
    fast_s = std::max(fast_s, rewrite(together, FlashOptions{}.per_wire).seconds);
  }
  std::printf("7 buses with 20 boards and one with 21: %.3f s one after the other, %.3f s in one pass\n", slow_s,
              fast_s);
  EXPECT_LT(fast_s, 0.5 * slow_s);
}

// Fresh boards are asked for the shapes of their patches at the same time.
TEST(TablePass, fresh_boards_look_at_their_patches_at_the_same_time) {
  std::array<double, 2> seconds{};
  for (const bool all : {false, true}) {
    hardware::Scene scene;
    scene.design = test::strip(136, 16);  // Eight boards have 16 modules and one has 8, so its shape identifies it.
    hardware::SimLink link(std::move(scene));
    session::Bus bus(link);
    FlashOptions options;
    options.recognise = true;
    options.per_wire = all ? FlashOptions{}.per_wire : 1;
    const std::uint64_t began_us = bus.now_us();
    try {
      (void)flash(bus, link.skin().scene().design, options);
      ADD_FAILURE() << "eight equal shapes were told apart";
    } catch (const DeviceError& e) {
      EXPECT_THAT(e.what(), HasSubstr("ambiguous which controller serves patches 0, 1, 2, 3, 4, 5, 6, 7:"));
    }
    seconds[all ? 1 : 0] = static_cast<double>(bus.now_us() - began_us) * 1e-6;
  }
  std::printf("shapes of nine boards: %.3f s one after the other, %.3f s at the same time, with what goes before\n",
              seconds[0], seconds[1]);
  EXPECT_LT(seconds[1], 0.6 * seconds[0]);
}

// One board is dead, one loses power in its flash, the image of one has no label, and each loses 1 % of the frames: the
// others get their tables, and the two are named.
TEST(TablePass, losses_a_dead_board_a_cut_supply_and_an_old_firmware) {
  constexpr std::size_t kDead = 3, kCut = 6, kOld = 10;
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    Boards boards(16);
    const auto package = test::make_firmware({.size_bytes = 2048, .fill = 1});
    for (std::size_t p = 0; p < 16; ++p) test::install(boards.skin(), p, 0, package);
    test::install(boards.skin(), kOld, 0, test::make_firmware({.size_bytes = 2048, .fill = 1, .labelled = false}));
    const design::Design old_design = boards.other();
    (void)flash(boards.bus(), old_design);
    FlashOptions options = taking_over();
    for (const wire::NodeClaim& c : boards.bus().discover())
      options.assign.push_back({layout::PatchIndex{c.node_address - 1}, session::to_text(c.unique_id)});
    const std::string dead = options.assign[kDead].serial, cut = options.assign[kCut].serial;
    boards.skin().flash(kCut).cut_power_after(std::mt19937(seed)() % 30, hardware::FlashMemory::Tear::kHalf);
    boards.skin().on_delivery([dice = std::mt19937(seed)](std::size_t p, const wire::CanFrame&) mutable {
      return p != kDead && dice() % 100 != 0;
    });
    std::string said;
    std::vector<FlashResult> results;
    try {
      flash_together(std::array{FlashPart{&boards.bus(), &boards.design(), options, {}}}, results);
    } catch (const link::Unreachable& e) {
      said = e.what();
    }
    EXPECT_THAT(said, HasSubstr("patch 6, controller " + cut + ": ")) << seed;
    EXPECT_THAT(said, HasSubstr("patch 3: sim: no controller " + dead + " answers")) << seed;
    EXPECT_THAT(said, HasSubstr("14 of 16 controllers have their table (patches 0, 1, 2, 4, 5, 7, "));
    EXPECT_THAT(said, Not(HasSubstr("patch 10")));
    boards.skin().on_delivery({});
    ASSERT_EQ(results.at(0).patches.size(), 16U);
    for (const FlashResult::Patch& r : results[0].patches) EXPECT_EQ(r.why.empty(), r.written) << r.patch;
    EXPECT_EQ(results[0].bytes,
              14 * session::bytes_of(session::image_of(boards.design(), layout::PatchIndex{0})).size());
    boards.skin().power_cycle(kCut);
    boards.bus().listen(boards.bus().now_us() + 100'000);
    for (std::size_t p = 0; p < 16; ++p) {
      const bool fresh = boards.holds(p, boards.design());
      EXPECT_EQ(fresh || boards.holds(p, old_design), true) << p;
      EXPECT_EQ(fresh, p != kDead && (p != kCut || fresh)) << p;
    }
    EXPECT_EQ(boards.flash(options).skipped, boards.holds(kCut, boards.design()) ? 15 : 14)
        << "run again, it completes";
  }
}

// Nobody can tell which of the fresh boards is missing, so certain ones are served and the others named.
TEST(TablePass, boards_that_are_certain_do_not_wait_for_one_that_is_missing) {
  Boards boards(4);
  (void)boards.flash();
  const auto claims = boards.bus().discover();
  for (const std::size_t fresh : {2U, 3U}) {
    for (std::size_t page = 0; page < 4; ++page) (void)boards.skin().flash(fresh).erase_page(page * 2048);
    boards.skin().power_cycle(fresh);
  }
  boards.skin().on_delivery([](std::size_t p, const wire::CanFrame&) { return p != 3; });
  FlashOptions options;
  options.force = true;
  try {
    (void)boards.flash(options);
    FAIL() << "complete without a board";
  } catch (const link::Unreachable&) {
    FAIL() << "waits for a cable";
  } catch (const DeviceError& e) {
    EXPECT_THAT(e.what(), HasSubstr("patch 2: sim: the design has 4 patches here, 3 controllers answer"));
    EXPECT_THAT(e.what(), HasSubstr("2 of 4 controllers have their table (patches 0, 1)"));
    EXPECT_THAT(e.what(), HasSubstr("\n  patch 3: "));
  }
  // The fresh board yielded the address to the one that has a table.
  EXPECT_FALSE(session::Controller(boards.bus(), 5).active_table().present());
}

}  // namespace
}  // namespace triskin::deploy
