// SPDX-License-Identifier: GPL-3.0-or-later
// One image to all controllers of a bus at once, on a bus whose frames take their time and whose flash takes its own.
#include "triskin/jobs/broadcast_update.hpp"

#include <gtest/gtest.h>

#include <random>

#include "faulty_link.hpp"
#include "firmware_file.hpp"
#include "fixture.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/wire/image_update.hpp"

namespace triskin::device {
namespace {

using test::install;
using test::make_firmware;

constexpr std::uint32_t kHundred = 100'000 / 8 * 8;

/// `boards` controllers with one module each; every second one runs from slot 1.
class Boards {
 public:
  Boards(std::size_t boards, bool fd, const FirmwarePackage& running) {
    scene::Scene scene;
    scene.design = strip(static_cast<int>(boards), 1);
    scene.effects.bus_bit_rate = 1'000'000;
    scene.effects.bus_data_bit_rate = 2'000'000;
    sim_ = std::make_unique<SimLink>(std::move(scene));
    if (!fd) sim_->skin().use_fd(false);
    link_ = std::make_unique<FaultyLink>(*sim_, fd, FaultyLink::Rates{}, 1);
    bus_ = std::make_unique<Bus>(*link_);
    for (std::size_t p = 0; p < boards; ++p) install(skin(), p, static_cast<int>(p % 2), running);
    bus_->listen(bus_->now_us() + 100'000);
    claims = bus_->discover();
  }
  /// Each receiver loses one frame of `one_in`, on its own.
  void lose(unsigned one_in, unsigned seed) {
    skin().on_delivery([one_in, random = std::mt19937(seed)](std::size_t, const wire::CanFrame&) mutable {
      return random() % one_in != 0;
    });
  }
  [[nodiscard]] scene::VirtualSkin& skin() { return sim_->skin(); }
  [[nodiscard]] Bus& bus() { return *bus_; }
  [[nodiscard]] FaultyLink& link() { return *link_; }
  [[nodiscard]] UpdateBus all() { return {bus_.get(), claims}; }
  [[nodiscard]] BroadcastResult update(const FirmwarePackage& package, const BroadcastOptions& options = {}) {
    return broadcast_firmware(std::array{all()}, package, options);
  }
  /// The board with patch `p`: unique ids are sorted by patch.
  [[nodiscard]] const BoardUpdate& of(const BroadcastResult& r, std::size_t p) const { return r.boards.at(p); }
  std::vector<wire::NodeClaim> claims;

 private:
  std::unique_ptr<SimLink> sim_;
  std::unique_ptr<FaultyLink> link_;
  std::unique_ptr<Bus> bus_;
};

FirmwarePackage old_firmware() {
  return make_firmware({.size_bytes = 2048, .fill = 1});
}

long count(const BroadcastResult& r, UpdateOutcome outcome) {
  return std::ranges::count(r.boards, outcome, &BoardUpdate::outcome);
}

// The case of the issue: 1 % of frames lost, one dead, one whose power is cut at a random moment, one with 0.1.
BroadcastResult hard_case(std::uint32_t bytes, bool fd, bool both_slots, unsigned seed) {
  constexpr std::size_t kDead = 3, kCut = 6, kOld = 10;
  Boards boards(16, fd, old_firmware());
  if (!both_slots) {
    for (std::size_t p = 1; p < 16; p += 2) {
      for (std::size_t at = 0; at < sim::kSlotsBytes; at += 2048) (void)boards.skin().slots(p).erase_page(at);
      install(boards.skin(), p, 0, old_firmware());
    }
  }
  for (std::size_t at = 0; at < sim::kSlotsBytes; at += 2048) (void)boards.skin().slots(kOld).erase_page(at);
  install(boards.skin(), kOld, 0, make_firmware({.size_bytes = 2048, .fill = 1, .labelled = false}));
  std::mt19937 random(seed);
  boards.skin().slots(kDead).cut_power_after(0, scene::FlashMemory::Tear::kHalf);
  (void)[&] {
    try {
      (void)boards.skin().slots(kDead).erase_page(0);
    } catch (const sim::PowerLost&) {
    }
    return 0;
  }();
  boards.skin().slots(kCut).cut_power_after(random() % (bytes / 8), scene::FlashMemory::Tear::kHalf);
  boards.lose(100, seed);
  const FirmwarePackage next = make_firmware({.size_bytes = bytes, .fill = 2});
  // Dead for the update: it does not hear anything.
  boards.skin().on_delivery([&, dice = std::mt19937(seed)](std::size_t p, const wire::CanFrame&) mutable {
    return p != kDead && dice() % 100 != 0;
  });
  const BroadcastResult r = boards.update(next);
  EXPECT_EQ(boards.of(r, kDead).outcome, UpdateOutcome::kGivenUp) << boards.of(r, kDead).why;
  EXPECT_EQ(boards.of(r, kCut).outcome, UpdateOutcome::kGivenUp) << boards.of(r, kCut).why;
  EXPECT_EQ(boards.of(r, kOld).outcome, UpdateOutcome::kByLoader) << boards.of(r, kOld).why;
  EXPECT_EQ(count(r, UpdateOutcome::kUpdated), 13) << "seed " << seed;
  boards.skin().on_delivery({});
  EXPECT_FALSE(boards.skin().alive(kCut));
  boards.skin().power_cycle(kCut);
  boards.bus().listen(boards.bus().now_us() + 100'000);
  EXPECT_EQ(boards.bus().discover().size(), 16U);
  EXPECT_EQ(boards.update(next, {.dry_run = true}).boards.at(kCut).outcome, UpdateOutcome::kWould);
  return r;
}

TEST(Broadcast, sixteen_boards_with_losses_one_dead_one_cut_one_old_on_a_classic_bus) {
  const BroadcastResult r = hard_case(kHundred, false, false, 22);
  EXPECT_LE(r.link_s, 4.0);
  std::printf("classic, 100 kB for one slot: %.2f s of bus time, %d rounds, %zu of %zu data frames sent again\n", r.link_s,
              r.rounds, r.again, r.frames);
}

TEST(Broadcast, two_slots_on_a_classic_bus) {
  const BroadcastResult r = hard_case(kHundred, false, true, 23);
  EXPECT_LE(r.link_s, 8.0);
  std::printf("classic, 100 kB for each slot: %.2f s of bus time, %d rounds, %zu of %zu data frames sent again\n",
              r.link_s, r.rounds, r.again, r.frames);
}

TEST(Broadcast, two_slots_on_a_bus_with_FD) {
  const BroadcastResult r = hard_case(kHundred, true, true, 24);
  std::printf("FD, 100 kB for each slot: %.2f s of bus time, %d rounds, %zu of %zu data frames sent again\n", r.link_s,
              r.rounds, r.again, r.frames);
  const BroadcastResult real = hard_case(64'000, true, true, 24);
  std::printf("FD, 64 kB for each slot: %.2f s of bus time\n", real.link_s);
}

}  // namespace
}  // namespace triskin::device
