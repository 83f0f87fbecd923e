// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <set>

#include "bench.hpp"
#include "triskin/board/budget.hpp"

namespace triskin::machine {
namespace {

TEST_F(Bench, LoaderStartsTheApplicationAt160MHz) {
  power_up();
  run_for(200'000);
  expect_no_violation();
  EXPECT_EQ(machine->sysclk_hz(), 160'000'000U);
  EXPECT_EQ(machine->vector_table(), application.origin());
  EXPECT_GT(budget(offsetof(board::Budget, loops)), 1U);
  EXPECT_GT(machine->counts().idle_us, 100'000U);  // The core sleeps instead of spinning.
}

TEST_F(Bench, AnswersUdsOnCan) {
  power_up();
  run_for(100'000);
  const auto hello = request({0x22, 0xFD, 0x00});
  ASSERT_GE(hello.size(), 26U);
  EXPECT_EQ(hello[0], 0x62);
  EXPECT_EQ(hello[12], 0x10);  // This is the first byte of the unique id.
  expect_no_violation();
}

// Measures the light of the board over a second, in tenths that it is on. It is read every 20 ms, since a flash can be
// shorter than a tenth: the loop that switches it sleeps up to 50 ms.
TEST_F(Bench, LightSaysWhatTheBoardDoes) {
  constexpr std::uint32_t kOutputsOfA = 0x48000014, kLight = 1U << 5;
  const auto on = [&] {
    int count = 0;
    for (int k = 0; k < 50; ++k) {
      run_for(20'000);
      count += (machine->read_register(kOutputsOfA) & kLight) != 0 ? 1 : 0;
    }
    return (count + 2) / 5;
  };
  power_up();
  run_for(450'000);  // The loader, the measurement of the crystal and the first pass are over by now.
  EXPECT_EQ(on(), 1) << "no table";
  store_table(patch(4));
  power_up();
  run_for(1'050'000);
  EXPECT_EQ(on(), 5) << "samples";
  unlock();
  ASSERT_EQ(request({0x2E, 0xFD, 0x05, 0x02}).at(0), 0x6E);
  run_for(100'000);
  EXPECT_EQ(on(), 9) << "streams";
  module_at(2).present = false;
  run_for(1'000'000);
  const int faulty = on();
  EXPECT_GE(faulty, 4) << "a module is missing";
  EXPECT_LE(faulty, 6);
  expect_no_violation();
}

constexpr std::uint32_t kFromFactory = 0xFFEFF8AA, kBootByPin = 1U << 26, kBootOptionFlash = 1U << 27,
                        kTwoBanks = 1U << 22, kBrownOutMask = 7U << 8, kBrownOut28 = 4U << 8;

TEST_F(Bench, FreshBoardOnAnIdleBusStartsTheRomsLoader) {
  flash.options = kFromFactory;
  power_up();
  run_for(500'000);
  EXPECT_TRUE(machine->in_rom_loader());
  EXPECT_TRUE(request({0x22, 0xFD, 0x00}).empty());
}

// The first start happens without a bus. Two seconds later the option bytes start from flash whatever the bus does, and
// the next power-up shows it.
TEST_F(Bench, FreshBoardIsSetToStartFromFlash) {
  flash.options = kFromFactory;
  boot_pin_high = false;
  power_up();
  run_for(1'500'000);
  EXPECT_EQ(budget(offsetof(board::Budget, options)), kFromFactory);
  EXPECT_EQ(budget(offsetof(board::Budget, findings)), board::finding::kBootByPin | board::finding::kLowBrownOut);
  // The options are not written before the supply has been stable for two seconds.
  EXPECT_EQ(flash.options, kFromFactory);
  run_for(1'500'000);
  EXPECT_EQ(flash.options, (kFromFactory & ~(kBootByPin | kBrownOutMask)) | kBootOptionFlash | kBrownOut28);
  expect_no_violation();
  boot_pin_high = true;
  power_up();
  run_for(200'000);
  EXPECT_FALSE(machine->in_rom_loader());
  EXPECT_FALSE(request({0x22, 0xFD, 0x00}).empty());
  EXPECT_EQ(budget(offsetof(board::Budget, findings)), board::finding::kBootPinHigh);
  expect_no_violation();
}

// Until the next power-up the register shows the old options, which was taken for a reason to write them again after
// each reset: an erase of 22 ms with the core stalled, and wear.
TEST_F(Bench, OptionsAreWrittenOnceUntilTheyCount) {
  const std::uint32_t set = (kFromFactory & ~(kBootByPin | kBrownOutMask)) | kBootOptionFlash | kBrownOut28;
  flash.options = kFromFactory;
  boot_pin_high = false;
  power_up();
  run_for(3'000'000);
  ASSERT_EQ(flash.options, set);
  flash.options = kFromFactory;  // so that another write shows
  ASSERT_EQ(request({0x11, 0x01}).at(0), 0x51);
  run_for(3'000'000);
  EXPECT_EQ(budget(offsetof(board::Budget, options)), kFromFactory);
  EXPECT_EQ(flash.options, kFromFactory);
  power_up();
  run_for(3'000'000);
  EXPECT_EQ(flash.options, set);
  expect_no_violation();
}

TEST_F(Bench, ReadProtectedChipKeepsItsOptionsAndSaysSo) {
  flash.options = (kFromFactory & ~0xFFU) | 0xBB;
  boot_pin_high = false;
  power_up();
  run_for(3'000'000);
  EXPECT_EQ(flash.options, (kFromFactory & ~0xFFU) | 0xBB);
  EXPECT_EQ(budget(offsetof(board::Budget, findings)),
            board::finding::kBootByPin | board::finding::kOptionsProtected | board::finding::kLowBrownOut);
  expect_no_violation();
}

// A store that clears a flag may reach the block after the handler has returned, and the handler then runs once more
// (RM0440 3.3.9 for the NMI, erratum 838869 of the Cortex-M4 for all). The model has no such delay, so the instructions
// of the running image are looked at.
class Handlers : public Bench {
 protected:
  [[nodiscard]] std::uint32_t half_word(std::uint32_t at) const {
    return machine->read_word(at & ~3U) >> (8 * (at & 2)) & 0xFFFF;
  }
  // Returns where a B.W or BL at this address leads (ARMv7-M, A7.7.12 and A7.7.18), or 0 if there is none.
  [[nodiscard]] std::uint32_t branch_target(std::uint32_t at) const {
    const std::uint32_t first = half_word(at), second = half_word(at + 2);
    if ((first & 0xF800) != 0xF000 || (second & 0x9000) != 0x9000) return 0;
    const std::uint32_t sign = first >> 10 & 1, i1 = ~(second >> 13 ^ sign) & 1, i2 = ~(second >> 11 ^ sign) & 1;
    const std::uint32_t offset =
        (sign != 0 ? 0xFF000000 : 0) | i1 << 23 | i2 << 22 | (first & 0x3FF) << 12 | (second & 0x7FF) << 1;
    return at + 4 + offset;
  }
  // The function waits itself, or one of `helpers` does so for it.
  [[nodiscard]] bool waits(std::uint32_t begin, const std::set<std::uint32_t>& helpers) const {
    constexpr std::uint32_t kDsb = 0x8F4FF3BF;
    const std::uint32_t end = *starts.upper_bound(begin);
    for (std::uint32_t at = begin; at + 2 < end; at += 2) {
      if ((half_word(at) | half_word(at + 2) << 16) == kDsb) return true;
      if (const std::uint32_t target = branch_target(at); helpers.contains(target)) return waits(target, {});
    }
    return false;
  }
  [[nodiscard]] std::uint32_t start_of(const char* name) const { return application.symbols.at(name) & ~1U; }
  std::set<std::uint32_t> starts;  ///< Functions and data begin here.
};

TEST_F(Handlers, WaitForTheirStoresBeforeTheyReturn) {
  power_up();
  run_for(200'000);
  for (const auto& [name, value] : application.symbols) starts.insert(value & ~1U);
  std::set<std::uint32_t> helpers{start_of("serve_timer")};
  if (application.symbols.contains("_ZN7triskin5board14InterruptTimerD1Ev"))
    helpers.insert(start_of("_ZN7triskin5board14InterruptTimerD1Ev"));
  const std::set<std::uint32_t> never_return{start_of("default_handler"), start_of("hard_fault_handler")};
  constexpr std::uint32_t kVtor = 0xE000ED08, kVectors = 16 + 102;
  const std::uint32_t table = machine->read_register(kVtor);
  int handlers = 0;
  for (std::uint32_t k = 2; k < kVectors; ++k) {
    const std::uint32_t begin = machine->read_word(table + 4 * k) & ~1U;
    if (begin == 0 || never_return.contains(begin)) continue;
    EXPECT_TRUE(waits(begin, helpers)) << "exception " << k;
    ++handlers;
  }
  EXPECT_GE(handlers, 12) << "NMI, timer, CAN, USB, eight of the lines";
}

// The units are of the page of tables that is not in use, which the application reads at each start.
constexpr std::uint32_t kSpareTable = 0x0807C800;
constexpr std::uint32_t kSpareUnit = (kSpareTable - FlashChip::kBase) / FlashChip::kUnit;

TEST_F(Bench, UnitWithOneWrongBitIsCorrectedAndCounted) {
  store_table(patch(2));
  for (std::uint32_t k = 0; k < FlashChip::kPage / FlashChip::kUnit; ++k) flash.weak.insert(kSpareUnit + k);
  power_up();
  run_for(300'000);
  const auto state = health();
  ASSERT_TRUE(state.has_value());
  EXPECT_GE(state->ecc_corrected, 1U);
  EXPECT_EQ(state->ecc_detected, 0U);
  EXPECT_EQ(machine->counts().resets, 0);
  expect_no_violation();
}

// With DBANK = 0 the upper one of two units has a flag of its own, which raises the NMI for ever until it is cleared.
TEST_F(Bench, UnitsWithTwoWrongBitsAreCountedAndTheBoardWorks) {
  for (const bool two_banks : {true, false}) {
    if (!two_banks) flash.options &= ~(1U << 22);
    store_table(patch(2));
    for (std::uint32_t k = 0; k < FlashChip::kPage / FlashChip::kUnit; ++k) flash.torn.insert(kSpareUnit + k);
    power_up();
    run_for(300'000);
    const auto state = health();
    ASSERT_TRUE(state.has_value()) << two_banks;
    EXPECT_GE(state->ecc_detected, 1U) << two_banks;
    EXPECT_EQ(machine->counts().resets, 0) << two_banks;
    expect_no_violation();
  }
}

// Pages have 4 KB, so an erase would also take the neighbour; it is refused.
TEST_F(Bench, ChipWithOneBankErasesNothing) {
  flash.options &= ~kTwoBanks;
  std::vector<FlashOperation> operations;
  flash.log = &operations;
  store_table(patch(4));
  power_up();
  run_for(100'000);
  EXPECT_EQ(budget(offsetof(board::Budget, findings)) & board::finding::kSingleBank, board::finding::kSingleBank);
  unlock();
  // Faults of absent modules fill the page of the fault memory; clearing them would erase the other page.
  module_at(0).present = false;
  run_for(600'000);
  (void)request({0x14, 0xFF, 0xFF, 0xFF});
  module_at(1).present = false;
  run_for(600'000);
  (void)request({0x14, 0xFF, 0xFF, 0xFF});
  EXPECT_EQ(std::ranges::count(operations, true, &FlashOperation::erase), 0);
  expect_no_violation();
}

}  // namespace
}  // namespace triskin::machine
