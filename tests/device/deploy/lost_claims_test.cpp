// SPDX-License-Identifier: GPL-3.0-or-later
// On a bus that loses frames, an update never ends well while a board that the command knows holds the old image.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "device/deploy/firmware_file.hpp"
#include "support/faulty_link.hpp"
#include "support/strip_design.hpp"
#include "triskin/deploy/broadcast_update.hpp"
#include "triskin/hardware/sim_link.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::deploy {
namespace {

constexpr std::size_t kBoards = 16;

// TRISKIN_UPDATES=5000 for the figures of the page on flashing.
unsigned updates() {
  const char* text = std::getenv("TRISKIN_UPDATES");
  return text != nullptr ? static_cast<unsigned>(std::strtoul(text, nullptr, 10)) : 40;
}

struct Outcome {
  bool complete = false;  // the command would end with status 0
  std::size_t old = 0;    // boards that run the old image
  std::size_t silent = 0;
};

// Reads the flash as the loader does, with the layout of docs/flash_layout.md: each slot ends with a page that begins
// with magic, sequence and size of the commit.
bool newest_image_is(Bytes slots, const FirmwarePackage& package) {
  constexpr std::size_t kSlot = sim::kSlotsBytes / 2, kPage = 2048;
  std::array<std::uint32_t, 2> sequence{};
  for (std::size_t slot = 0; slot < 2; ++slot) {
    ByteReader record(slots.subspan((slot + 1) * kSlot - kPage, 8));
    if (record.le32() == layout::kCommitMagic) sequence[slot] = record.le32();
  }
  const std::size_t newest = sequence[1] > sequence[0] ? 1 : 0;
  const Bytes image = package.image(static_cast<int>(newest));
  return std::ranges::equal(slots.subspan(newest * kSlot, image.size()), image);
}

// The step before the update has seen all boards, as flashing tables does.
Outcome update_on_a_bad_bus(unsigned percent, unsigned seed) {
  static const FirmwarePackage old_one = test::make_firmware({.fill = 1}), next = test::make_firmware({.fill = 2});
  hardware::Scene scene;
  scene.design = test::strip(static_cast<int>(kBoards), 1);
  hardware::SimLink sim(std::move(scene));
  sim.skin().use_fd(false);
  for (std::size_t p = 0; p < kBoards; ++p) test::install(sim.skin(), p, static_cast<int>(p % 2), old_one);
  session::Bus clean(sim);
  clean.listen(clean.now_us() + 100'000);
  (void)clean.discover();
  test::FaultyLink bad(sim, false, {.drop = percent}, seed);
  const std::array<link::Link*, 1> links{&bad};
  const BoardsOnWires found = find_boards(links, clean.known());
  const BroadcastResult r = broadcast_firmware(found.boards, next);
  clean.listen(clean.now_us() + 100'000);
  Outcome outcome{.complete = r.complete() && found.silent.empty(), .silent = found.silent.size()};
  for (std::size_t p = 0; p < kBoards; ++p) outcome.old += newest_image_is(sim.skin().slots(p).bytes(), next) ? 0 : 1;
  return outcome;
}

TEST(LostClaims, no_update_ends_well_with_an_old_image_on_a_board) {
  for (const unsigned percent : {1U, 5U, 10U}) {
    unsigned complete = 0, with_silent = 0;
    std::size_t old = 0;
    for (unsigned seed = 1; seed <= updates(); ++seed) {
      const Outcome o = update_on_a_bad_bus(percent, seed);
      EXPECT_TRUE(!o.complete || o.old == 0) << percent << " % lost, seed " << seed;
      complete += o.complete ? 1 : 0;
      with_silent += o.silent > 0 ? 1 : 0;
      old += o.old;
    }
    EXPECT_GT(complete, percent == 1 ? updates() * 9 / 10 : 0U) << percent << " % lost";
    std::printf(
        "%u %% of frames lost, seeds 1 … %u: %u of %u updates of 16 boards complete; %zu boards with the old "
        "image, all in an update that said so; %u updates with a board that never claimed\n",
        percent, updates(), complete, updates(), old, with_silent);
  }
}

// The table step knows 16 boards; then one falls silent for good.
TEST(LostClaims, a_board_that_falls_silent_between_two_steps_is_named) {
  hardware::Scene scene;
  scene.design = test::strip(3, 1);
  hardware::SimLink sim(std::move(scene));
  session::Bus before(sim);
  const auto claims = before.discover();
  ASSERT_EQ(claims.size(), 3U);
  std::size_t silenced = 0;
  sim.skin().on_delivery([&](std::size_t p, const wire::CanFrame& frame) {
    silenced += p == 1 && frame.id == wire::kWhoIsThereId ? 1 : 0;
    return p != 1;
  });
  const std::array<link::Link*, 1> links{&sim};
  const BoardsOnWires found = find_boards(links, before.known());
  ASSERT_EQ(found.silent.size(), 1U);
  EXPECT_EQ(found.silent[0], claims[1].unique_id);
  EXPECT_EQ(found.boards.at(0).boards.size(), 2U);
  EXPECT_EQ(silenced, 2U + 8U) << "asked twice as everybody, then eight times as one that is known";
  EXPECT_EQ(find_boards(links, {}).silent.size(), 0U) << "nobody told this step about it";
}

// The answers of board 1 to the first seven questions are lost.
TEST(LostClaims, one_that_answered_before_is_asked_up_to_eight_times) {
  hardware::Scene scene;
  scene.design = test::strip(2, 1);
  hardware::SimLink sim(std::move(scene));
  session::Bus bus(sim);
  ASSERT_EQ(bus.discover().size(), 2U);
  std::size_t questions = 0;
  sim.skin().on_delivery([&](std::size_t p, const wire::CanFrame& frame) {
    return p != 1 || frame.id != wire::kWhoIsThereId || ++questions == 8;
  });
  const auto claims = bus.discover();
  EXPECT_EQ(claims.size(), 2U);
  EXPECT_TRUE(bus.silent(claims).empty());
  EXPECT_EQ(questions, 8U);
}

}  // namespace
}  // namespace triskin::deploy
