// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a new board: an erased chip, the factory file as a programmer writes it, and all events of a board's first half
// minute.
#include <fmt/format.h>

#include <algorithm>
#include <random>

#include "sampling_bench.hpp"
#include "triskin/board/budget.hpp"

namespace triskin::machine {
namespace {

constexpr std::uint32_t kSlotA = 0x08004000;
// docs/flash_layout.md, flash map: the marks begin 1,024 bytes into the page of records, three starts before the
// confirmation; their first four bytes are "TSKM".
constexpr std::uint32_t kStarts = kSlotA + 0x3B800 + 1024, kConfirmation = kStarts + 3 * 8, kMark = 0x4D4B5354;

struct Crystal {
  const char* name;
  std::uint64_t hz;
  wire::Crystal state;
};
constexpr std::array kCrystals{
    Crystal{"8MHz", 8'000'000, wire::Crystal::kUsed},        Crystal{"16MHz", 16'000'000, wire::Crystal::kUsed},
    Crystal{"24MHz", 24'000'000, wire::Crystal::kUsed},      Crystal{"25MHz", 25'000'000, wire::Crystal::kUsed},
    Crystal{"40MHz", 40'000'000, wire::Crystal::kUsed},      Crystal{"missing", 0, wire::Crystal::kSilent},
    Crystal{"overtone", 18'432'000, wire::Crystal::kUnknown}};

class NewBoard : public Sampling,
                 public ::testing::WithParamInterface<std::tuple<std::size_t, const char*, const char*>> {
 protected:
  void SetUp() override {
    running_slot = 0;
    Bench::SetUp();
    behave(behaviour_named(std::get<2>(GetParam())));
    crystal_hz = crystal().hz;
    flash = FlashChip{};
    flash.program_file(firmware(std::get<1>(GetParam())));
    flash.options &= ~(1U << 26);
  }
  [[nodiscard]] static const Crystal& crystal() { return kCrystals.at(std::get<0>(GetParam())); }
};

// Follows the whole bring-up guide with each crystal, from either file, with chips that restart their sequence on a
// write to power control and with chips that do not.
TEST_P(NewBoard, FromTheFactoryFileToTheStream) {
  power_up();
  run_for(200'000);
  EXPECT_EQ(machine->vector_table(), kSlotA);
  EXPECT_EQ(machine->sysclk_hz(), 160'000'000U);
  const auto state = health();
  ASSERT_TRUE(state.has_value());
  EXPECT_EQ(state->clock.crystal, crystal().state);
  const bool used = crystal().state == wire::Crystal::kUsed;
  EXPECT_EQ(state->clock.crystal_mhz, used ? crystal().hz / 1'000'000 : 0U);
  EXPECT_NEAR(state->clock.measured_khz, static_cast<double>(crystal().hz) / 1000,
              0.001 * static_cast<double>(crystal().hz) / 1000);
  EXPECT_EQ((state->findings & board::finding::kNoCrystal) != 0, !used);
  EXPECT_EQ(state->reset_cause, wire::reset_cause::kPower);
  run_for(10'000);
  EXPECT_TRUE(confirmed()) << "it has answered a request";
  ASSERT_TRUE(flash_table(patch(4)));
  ASSERT_EQ(request({0x2E, 0xFD, 0x05, 0x02}).at(0), 0x6E);
  run_for(500'000);
  EXPECT_EQ(samples().size(), 4U);
  expect_no_violation();
}

INSTANTIATE_TEST_SUITE_P(Crystals, NewBoard,
                         ::testing::Combine(::testing::Range(std::size_t{0}, kCrystals.size()),
                                            ::testing::Values("triskin_factory.hex", "triskin_factory.bin"),
                                            ::testing::Values("ConvReset", "PowerRestarts")),
                         [](const auto& tested) {
                           const std::string file = std::get<1>(tested.param);
                           return fmt::format("{}_{}_{}", kCrystals.at(std::get<0>(tested.param)).name,
                                              file.substr(file.size() - 3), std::get<2>(tested.param));
                         });

class FirstStart : public Sampling {
 protected:
  void SetUp() override {
    running_slot = 0;
    Bench::SetUp();
  }
};

// Three of these used to leave the board in its loader for ever, because its only image had not been confirmed.
TEST_F(FirstStart, PowerCutsBeforeItHasWorkedStrandNobody) {
  for (int start = 1; start <= 8; ++start) {
    power_up();
    run_for(100'000);
    EXPECT_EQ(machine->vector_table(), kSlotA) << start;
  }
  expect_no_violation();
}

// Uptime alone proves nothing, because without a table and without a host the image has done nothing.
TEST_F(FirstStart, UptimeConfirmsNothing) {
  power_up();
  run_for(5'000'000);
  EXPECT_EQ(machine->read_word(kConfirmation), 0xFFFFFFFFU);
  EXPECT_FALSE(request({0x22, 0xFD, 0x00}).empty());
  run_for(10'000);
  EXPECT_EQ(machine->read_word(kConfirmation), kMark);
}

TEST_F(FirstStart, CompletedReadingsConfirmWithoutAHost) {
  store_table(patch(4));
  power_up();
  run_for(1'000'000);
  EXPECT_EQ(machine->read_word(kConfirmation), kMark);
}

class FilledUp : public FirstStart, public ::testing::WithParamInterface<int> {};

// Programmers write the block of the commit record whole. A block of the size of the page has zeros in the marks, too:
// no mark can be written then, but none is seen either, so the board starts.
TEST_P(FilledUp, MarksAreWrittenWhateverAProgrammerFillsUpWith) {
  flash.program_file(firmware("triskin_factory.hex"), {1024, static_cast<std::uint8_t>(GetParam())});
  for (int start = 1; start <= 2; ++start) {
    power_up();
    run_for(100'000);
    ASSERT_EQ(machine->vector_table(), kSlotA);
    EXPECT_EQ(machine->read_word(kStarts + static_cast<std::uint32_t>(start - 1) * 8), kMark) << "start " << start;
  }
  EXPECT_EQ(machine->read_word(kConfirmation), 0xFFFFFFFFU);
  EXPECT_TRUE(health().has_value());
  run_for(10'000);
  EXPECT_TRUE(confirmed());
  EXPECT_EQ(machine->read_word(kConfirmation), kMark);
  expect_no_violation();
}

INSTANTIATE_TEST_SUITE_P(Values, FilledUp, ::testing::Values(0xFF, 0x00));

TEST_F(FirstStart, APageFullOfZerosIsNoConfirmation) {
  flash.program_file(firmware("triskin_factory.hex"), {2048, 0x00});
  power_up();
  run_for(100'000);
  ASSERT_EQ(machine->vector_table(), kSlotA);
  EXPECT_FALSE(confirmed());
}

// Each of 200 boards is reset or loses power up to five times within its first 30 s.
TEST_F(FirstStart, RandomResetsAndPowerCutsEndInTheApplication) {
  constexpr unsigned kSeed = 40;
  constexpr int kBoards = 200;
  std::mt19937 random(kSeed);
  const FlashChip fresh = flash;
  int resets = 0, cuts = 0;
  power_up(true);
  for (int chip = 0; chip < kBoards; ++chip) {
    flash.cut_at = ~std::uint64_t{0};
    machine->power_cycle(fresh);
    const std::uint64_t begin_us = now_us();
    for (auto k = 1 + random() % 5; k > 0; --k) {
      // Most cuts fall when something is written and decided, soon after a start; some fall anywhere in the half
      // minute.
      run_for(random() % 4 == 0 ? random() % 6'000'000 : random() % 60'000);
      if (now_us() > begin_us + 30'000'000) break;
      if (random() % 2 == 0) {
        machine->press_reset();
        ++resets;
        continue;
      }
      const FlashChip left = flash;
      machine->power_cycle(left);
      ++cuts;
    }
    // A double reset leads into the loader, which continues after 15 s without a host.
    run_for(200'000);
    if (machine->vector_table() != kSlotA) run_for(16'000'000);
    ASSERT_EQ(machine->vector_table(), kSlotA) << "board " << chip << " of seed " << kSeed;
  }
  std::printf("%d boards, %d resets and %d power cuts: all end in the application\n", kBoards, resets, cuts);
  EXPECT_GT(resets, kBoards);
  EXPECT_GT(cuts, kBoards);
}

class CrystalThatStops : public FirstStart, public ::testing::WithParamInterface<const char*> {};

TEST_P(CrystalThatStops, LeavesTheBoardWithItsInternalOscillator) {
  behave(behaviour_named(GetParam()));
  crystal_fails_at_us = 500'000;
  power_up();
  run_for(400'000);
  EXPECT_EQ(health().value().clock.crystal, wire::Crystal::kUsed);
  run_for(400'000);
  const auto state = health();
  ASSERT_TRUE(state.has_value());
  EXPECT_EQ(machine->sysclk_hz(), 160'000'000U);
  EXPECT_EQ(state->clock.crystal, wire::Crystal::kSilent);
  EXPECT_EQ(crash().value().cause, wire::CrashCause::kClock);
  EXPECT_EQ(machine->counts().resets, 1);
  ASSERT_TRUE(flash_table(patch(4)));
  ASSERT_EQ(request({0x2E, 0xFD, 0x05, 0x02}).at(0), 0x6E);
  run_for(500'000);
  EXPECT_EQ(samples().size(), 4U);
  expect_no_violation();
}

INSTANTIATE_TEST_SUITE_P(Restarts, CrystalThatStops, ::testing::Values("ConvReset", "PowerRestarts"),
                         [](const auto& tested) { return std::string(tested.param); });

// An unused line without resistors floats; it used to be "found held low" for ever. No module of the table is there,
// so it is looked at only when a host asks which addresses answer.
TEST_F(FirstStart, LineWithoutPullUpsIsNoFault) {
  lines[3].pull_ups = false;
  lines[3].modules.clear();
  store_table(patch(3));
  power_up();
  run_for(1'000'000);
  ASSERT_EQ(request({0x31, 0x01, 0x02, 0x01}).at(0), 0x71);
  run_for(500'000);
  const auto answers = request({0x31, 0x03, 0x02, 0x01});
  ASSERT_EQ(answers.size(), 4U + 13U);
  EXPECT_EQ(answers[4], 1) << "done";
  EXPECT_EQ(answers[5 + 9], 0) << "line 4 is held low";
  EXPECT_EQ(answers[5 + 10], 0) << "addresses at line 4";
  const auto states = request({0x22, 0xFD, 0x06});
  ASSERT_EQ(states.size(), 23U);
  EXPECT_EQ(states[3 + 15], 0) << "line 4 is held low";
  EXPECT_EQ(ByteReader(Bytes(states).subspan(3 + 16)).be32(), 0U) << "recoveries of line 4";
  EXPECT_GT(lines[3].first_start_us, 0U) << "nobody has sent an address on line 4";
  expect_no_violation();
}

}  // namespace
}  // namespace triskin::machine
