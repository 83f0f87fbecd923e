// SPDX-License-Identifier: GPL-3.0-or-later
// Power fails in the middle of each flash operation of an update, from the first erase to the confirmation. After that
// a controller has only the content of its cells, so the update runs once, its operations are recorded, and for each of
// them a machine boots from the cells as that operation tore them.
#include <algorithm>
#include <array>
#include <cstdlib>

#include "machine_link.hpp"
#include "triskin/deploy/broadcast_update.hpp"
#include "update_bench.hpp"

namespace triskin::machine {
namespace {

constexpr int kShards = 4;
constexpr std::array kOrigins{kSlotA, kSlotB};

class UpdateCuts : public Update, public ::testing::WithParamInterface<int> {
 protected:
  void by_loader() {
    enter_loader();
    ASSERT_EQ(erase(1), 0);
    ASSERT_EQ(write_image(), 0);
    ASSERT_EQ(commit(), 0);
    boot();
  }
  void by_broadcast() {
    power_up();
    run_for(100'000);
    MachineLink link({[this](const wire::CanFrame& f) { deliver(f); }, [this](std::uint64_t us) { run_for(us); },
                      [this] { return now_us(); }, &frames, [this] { return machine->frames_waiting(); }},
                     false);
    session::Bus bus(link);
    const auto package = package_of(application, read_elf(firmware("triskin_app_b.elf")));
    const auto result =
        deploy::broadcast_firmware(std::array{deploy::UpdateBus{&bus, bus.discover()}}, package, {.force = true});
    ASSERT_EQ(result.boards.at(0).outcome, deploy::UpdateOutcome::kUpdated) << result.boards.at(0).why;
  }
  // Records the operations of an update into `slot`, and cuts the power in those that `taken` selects.
  template <class Way, class Taken>
  void cut_each(int slot, Way way, Taken taken);
  // Waits until a controller answers which image it runs; empty after 300 ms.
  std::vector<std::uint8_t> boot_and_ask() {
    machine->power_cycle(torn_cells);
    frames.clear();
    run_for(25'000);
    for (int k = 0; k < 3; ++k) {
      const auto state = request({0x22, 0xFD, 0x09}, 30'000);
      if (!state.empty()) return state;
    }
    return {};
  }
  // Returns how many operations lead up to the commit record, whose second unit makes the slot valid.
  static std::size_t up_to_commit(int slot, const std::vector<FlashOperation>& operations) {
    const std::uint32_t record =
        (kOrigins[static_cast<std::size_t>(slot)] + 0x3B800 + 8 - FlashChip::kBase) / FlashChip::kUnit;
    const auto at =
        std::ranges::find_if(operations, [record](const FlashOperation& o) { return !o.erase && o.index == record; });
    return static_cast<std::size_t>(at - operations.begin()) + 1;
  }
  FlashChip torn_cells;
};

template <class Way, class Taken>
void UpdateCuts::cut_each(int slot, Way way, Taken taken) {
  const std::uint32_t new_origin = kOrigins.at(static_cast<std::size_t>(slot)),
                      old_origin = kOrigins.at(static_cast<std::size_t>(1 - slot));
  const FlashChip before = flash;
  std::vector<FlashOperation> operations;
  flash.log = &operations;
  way();
  if (HasFatalFailure()) return;
  const std::size_t committed = up_to_commit(slot, operations);
  run_for(2'500'000);
  const auto updated = request({0x22, 0xFD, 0x09});
  ASSERT_GE(updated.size(), 3U + 14);
  ASSERT_EQ(updated[3], slot);
  ASSERT_EQ(updated[4], 1) << "confirmed";
  ASSERT_GT(operations.size(), committed) << "its start and its confirmation are written";
  flash.log = nullptr;
  const FlashChip after = flash;  // The machine continues on the same chip.

  FlashChip cells = before;
  cells.log = nullptr;
  power_up(true);
  torn_cells = before;
  const auto old = boot_and_ask();
  ASSERT_EQ(old.size(), updated.size());
  int new_ones = 0, cuts = 0;
  for (std::size_t k = 0; k < operations.size(); ++k) {
    if (static_cast<int>(k % kShards) == GetParam() && taken(k, operations)) {
      torn_cells = cells;
      torn_cells.apply(operations[k], true);
      const auto state = boot_and_ask();
      ASSERT_EQ(state.size(), old.size()) << "cut in operation " << k << ": it does not boot";
      const bool is_new = state[3] == slot;
      // Slot, sequence, size and CRC are those of one image or the other.
      EXPECT_TRUE(std::equal(state.begin() + 5, state.end(), (is_new ? updated : old).begin() + 5))
          << "cut in operation " << k;
      EXPECT_EQ(is_new, k >= committed) << "cut in operation " << k;
      EXPECT_EQ(machine->vector_table(), is_new ? new_origin : old_origin) << "cut in operation " << k;
      new_ones += is_new ? 1 : 0;
      ++cuts;
    }
    cells.apply(operations[k], false);
  }
  EXPECT_TRUE(cells.bytes == after.bytes) << "the log is not what happened";
  expect_no_violation();
  std::printf("%d of %zu operations cut: %d old, %d new application\n", cuts, operations.size(), cuts - new_ones,
              new_ones);
}

// Selects every erase, the first and last operations, and one unit of `one_in` between; with TRISKIN_ALL_CUTS every
// operation.
auto sample(std::size_t one_in) {
  const bool all = std::getenv("TRISKIN_ALL_CUTS") != nullptr;
  return [all, one_in](std::size_t k, const std::vector<FlashOperation>& operations) {
    constexpr std::size_t kEnds = 60;
    return all || operations[k].erase || k < kEnds || k + kEnds > operations.size() || k / kShards % one_in == 0;
  };
}

TEST_P(UpdateCuts, EachLeavesTheOldOrTheNewApplicationAndItBoots) {
  cut_each(1, [this] { by_loader(); }, sample(8));
}

TEST_P(UpdateCuts, OfABroadcastLeaveTheOldOrTheNewApplicationAndItBoots) {
  cut_each(1, [this] { by_broadcast(); }, sample(32));
}

TEST_P(UpdateCuts, OfABroadcastIntoTheFirstSlotLeaveTheOldOrTheNewApplicationAndItBoots) {
  by_broadcast();
  run_for(2'500'000);  // The image that runs from the second slot is confirmed by now.
  if (!HasFatalFailure()) cut_each(0, [this] { by_broadcast(); }, sample(32));
}

INSTANTIATE_TEST_SUITE_P(Shards, UpdateCuts, ::testing::Range(0, kShards));

}  // namespace
}  // namespace triskin::machine
