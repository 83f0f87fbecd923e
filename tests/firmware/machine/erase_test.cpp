// SPDX-License-Identifier: GPL-3.0-or-later
// A page is erased while sixteen modules stream, from either slot: the lines must continue.
#include <algorithm>

#include "failure.hpp"
#include "sampling_bench.hpp"
#include "triskin/board/budget.hpp"
#include "usb_stream.hpp"

namespace triskin::machine {
namespace {

constexpr std::uint64_t kSequence_us = 9'200;
constexpr int kFaultyModule = 5;

class Erase : public Sampling, public ::testing::WithParamInterface<int> {
 protected:
  void SetUp() override {
    running_slot = GetParam();
    watch_reads = true;
    Bench::SetUp();
  }
  [[nodiscard]] long erases() const { return std::ranges::count(operations, true, &FlashOperation::erase); }
  // Records, repairs and clears a fault: the confirmed records move to the other page, which is erased for it.
  void record_and_clear_a_fault(std::uint64_t phase_us) {
    inject(Failure::kSaturated, line_of(kFaultyModule), kFaultyModule, now_us());
    run_for(200'000);
    repair(Failure::kSaturated, line_of(kFaultyModule), kFaultyModule);
    run_for(200'000 + phase_us);
    ASSERT_EQ(request({0x14, 0xFF, 0xFF, 0xFF}), std::vector<std::uint8_t>{0x54});
    run_for(50'000);
  }
  // Returns the longest time between two readings of a module; all twelve taxels of each must be there.
  [[nodiscard]] std::uint64_t worst_gap_us() const {
    std::uint64_t worst = 0;
    for (const auto& [m, list] : samples()) {
      for (std::size_t k = 1; k < list.size(); ++k)
        worst = std::max<std::uint64_t>(worst, list[k].device_time_us - list[k - 1].device_time_us);
    }
    return worst;
  }
  std::vector<FlashOperation> operations;
};

TEST_P(Erase, OfAPageWhileStreamingLosesNoSequenceBeyondTheOneUnderWay) {
  flash.log = &operations;
  start(16, {wire::Decimation::k64, 1});
  ASSERT_EQ(machine->vector_table(), application.origin());
  run_for(1'000'000);           // Every chip's clock is known by now.
  record_and_clear_a_fault(0);  // The first page of a new board needs no erase.
  operations.clear();
  frames.clear();
  const Time stalled_before = machine->counts().flash_stall;
  const std::uint64_t begin_us = now_us();
  constexpr int kErases = 6;
  for (int k = 0; k < kErases; ++k) record_and_clear_a_fault(static_cast<std::uint64_t>(k) * 1'700);
  const std::uint64_t took_us = now_us() - begin_us;
  EXPECT_EQ(erases(), kErases);
  EXPECT_LE(worst_gap_us(), 2 * kSequence_us);
  for (const auto& [m, list] : samples()) {
    const double sequences = static_cast<double>(took_us) / static_cast<double>(module_at(m).chip->sequence_us());
    EXPECT_GE(static_cast<double>(list.size()), 0.99 * sequences - 1) << m;
    if (m == kFaultyModule) continue;
    for (const auto& t : list) EXPECT_EQ(t.valid, 0xFFF) << m;
  }
  EXPECT_EQ(machine->counts().flash_stall, stalled_before) << "code or constants in the bank that is erased";
  EXPECT_EQ(machine->counts().flash_read_stalls, 0U);
  EXPECT_EQ(budget(offsetof(board::Budget, can_lost)), 0U);
  std::printf("slot %c: %ld erases while streaming, longest time between two readings %.1f ms\n", "AB"[running_slot],
              erases(), static_cast<double>(worst_gap_us()) / 1000);
  expect_no_violation();
}

// The same holds with the stream over USB, which a host reads all the time. From slot B the code that sends its packets
// used to lie in the bank that is erased, and everything stopped for 22 ms.
TEST_P(Erase, OfAPageWhileAUsbHostReadsLosesNoSequenceBeyondTheOneUnderWay) {
  flash.log = &operations;
  store_table(patch(16));
  power_up();
  UsbStream usb(*machine);
  ASSERT_TRUE(usb.open());
  ASSERT_TRUE(usb.unlock_and_stream());
  const auto listen = [&](std::uint64_t us) {
    for (const std::uint64_t until = now_us() + us; now_us() < until;) {
      if (const auto frame = usb.next()) frames.push_back(*frame);
    }
  };
  listen(1'000'000);
  const auto record_and_clear = [&](std::uint64_t phase_us) {
    inject(Failure::kSaturated, line_of(kFaultyModule), kFaultyModule, now_us());
    listen(200'000);
    repair(Failure::kSaturated, line_of(kFaultyModule), kFaultyModule);
    listen(200'000 + phase_us);
    usb.ask({0x14, 0xFF, 0xFF, 0xFF}, frames);
    listen(50'000);
  };
  record_and_clear(0);
  operations.clear();
  frames.clear();
  const Time stalled_before = machine->counts().flash_stall;
  constexpr int kErases = 6;
  for (int k = 0; k < kErases; ++k) record_and_clear(static_cast<std::uint64_t>(k) * 1'700);
  EXPECT_EQ(erases(), kErases);
  EXPECT_EQ(samples().size(), 16U);
  constexpr std::uint64_t kUsbFrame_us = 1'000;  // A sample waits up to a frame for the host to fetch it.
  EXPECT_LE(worst_gap_us(), 2 * kSequence_us + kUsbFrame_us);
  for (const auto& [m, list] : samples()) {
    for (std::size_t k = 1; k < list.size(); ++k) EXPECT_LE(list[k].sample, list[k - 1].sample + 2) << m;
  }
  EXPECT_EQ(machine->counts().flash_stall, stalled_before) << "code or constants in the bank that is erased";
  EXPECT_EQ(machine->counts().flash_read_stalls, 0U);
  std::printf("slot %c: %ld erases while a USB host reads, longest time between two readings %.1f ms\n",
              "AB"[running_slot], erases(), static_cast<double>(worst_gap_us()) / 1000);
  expect_no_violation();
}

INSTANTIATE_TEST_SUITE_P(Slots, Erase, ::testing::Values(0, 1),
                         [](const auto& tested) { return std::string(tested.param == 0 ? "A" : "B"); });

}  // namespace
}  // namespace triskin::machine
