// SPDX-License-Identifier: GPL-3.0-or-later
// The image in the machine takes another image by broadcast while sixteen modules stream, and starts it.
#include <cstdio>

#include "machine_link.hpp"
#include "sampling_bench.hpp"
#include "triskin/board/budget.hpp"
#include "triskin/deploy/broadcast_update.hpp"
#include "triskin/wire/node_claim.hpp"
#include "triskin/wire/stream_lease.hpp"

namespace triskin::machine {
namespace {

constexpr std::uint32_t kSlotOrigin[2] = {0x08004000, 0x08040000};

class Broadcast : public Sampling, public ::testing::WithParamInterface<std::tuple<int, bool>> {
 protected:
  void SetUp() override {
    running_slot = std::get<0>(GetParam());
    watch_reads = true;
    Bench::SetUp();
  }
  [[nodiscard]] deploy::FirmwarePackage package() const {
    return package_of(read_elf(firmware("triskin_app_a.elf")), read_elf(firmware("triskin_app_b.elf")));
  }
  [[nodiscard]] MachineLink link(bool fd) {
    return MachineLink({[this](const wire::CanFrame& f) { deliver(f); }, [this](std::uint64_t us) { run_for(us); },
                        [this] { return now_us(); }, &frames, [this] { return machine->frames_waiting(); }},
                       fd);
  }
  // Counts readings that were due but missing over all modules, and the longest time between two of one module.
  struct Account {
    std::size_t read = 0, missing = 0;
    std::uint64_t worst_gap_us = 0;
  };
  [[nodiscard]] Account account() const {
    Account a;
    for (const auto& [m, list] : samples()) {
      a.read += list.size();
      for (std::size_t k = 1; k < list.size(); ++k) {
        a.missing += list[k].sample - list[k - 1].sample - 1;
        a.worst_gap_us = std::max<std::uint64_t>(a.worst_gap_us, list[k].device_time_us - list[k - 1].device_time_us);
      }
    }
    return a;
  }
};

TEST_P(Broadcast, TakesAnImageWhileSixteenModulesStreamAndStartsIt) {
  const bool fd = std::get<1>(GetParam());
  start(16, {wire::Decimation::k64, 1});
  run_for(2'000'000);  // The image is confirmed by now.
  const Time stalled_before = machine->counts().flash_stall;
  frames.clear();
  MachineLink host = link(fd);
  session::Bus bus(host);
  const auto claims = bus.discover();
  ASSERT_EQ(claims.size(), 1U) << "discovery does not come through the filters";
  std::map<std::string, std::uint64_t> stage_us;
  Account before_restart;
  Time stalled = 0;
  std::uint32_t lost = 0, worst_loop_us = 0;
  const auto result = deploy::broadcast_firmware(std::array{deploy::UpdateBus{&bus, claims}}, package(),
                                                 {.force = true}, [&](const Progress& p) {
                                                   if (!stage_us.contains(p.stage)) stage_us[p.stage] = now_us();
                                                   if (p.stage != "checking") return;
                                                   before_restart = account();
                                                   stalled = machine->counts().flash_stall - stalled_before;
                                                   lost = budget(offsetof(board::Budget, can_lost));
                                                   worst_loop_us = budget(offsetof(board::Budget, worst_loop_us));
                                                 });
  ASSERT_EQ(result.boards.at(0).outcome, deploy::UpdateOutcome::kUpdated) << result.boards.at(0).why;
  EXPECT_EQ(machine->vector_table(), kSlotOrigin[1 - running_slot]);
  EXPECT_EQ(stalled, 0U) << "code or constants in the bank that is written";
  EXPECT_EQ(machine->counts().flash_read_stalls, 0U);
  EXPECT_EQ(budget(offsetof(board::Budget, flash_errors)), 0U);
  std::printf(
      "slot %c, %s: %zu bytes in %.2f s, %zu data frames, %zu again, %d rounds; %zu samples, %zu missing, longest gap "
      "%.1f "
      "ms; %u frames lost in the queue, longest pass %.2f ms\n",
      "AB"[running_slot], fd ? "FD" : "classic", result.boards.at(0).bytes, result.link_s, result.frames, result.again,
      result.rounds, before_restart.read, before_restart.missing,
      static_cast<double>(before_restart.worst_gap_us) / 1000, lost, static_cast<double>(worst_loop_us) / 1000);
  for (const auto& [stage, us] : stage_us)
    std::printf("  %s from %.3f s\n", stage.c_str(), static_cast<double>(us) * 1e-6);
  expect_no_violation();
}

// Frames for all controllers must pass the filters of the image.
class Filters : public Sampling {};

TEST_F(Filters, LetDiscoveryAssignmentAndLeasesThrough) {
  store_table(patch(4));
  power_up();
  run_for(1'000'000);
  deliver(wire::who_is_there());
  run_for(5'000);
  wire::IdFrames parts;
  std::optional<wire::IdFrames::Joined> claim;
  for (const wire::CanFrame& f : frames) {
    if (wire::is_claim(f)) claim = parts.add(f);
  }
  ASSERT_TRUE(claim);
  EXPECT_EQ(claim->a, 1);
  frames.clear();
  deliver(wire::encode_lease({.reader = 7, .lasts_10ms = 50}));
  run_for(200'000);
  EXPECT_EQ(samples().size(), 4U);
  for (const wire::CanFrame& f : wire::encode_assignment(claim->unique_id, 9)) deliver(f);
  run_for(100'000);
  frames.clear();
  deliver(wire::who_is_there());
  run_for(5'000);
  for (const wire::CanFrame& f : frames) {
    if (wire::is_claim(f)) claim = parts.add(f);
  }
  ASSERT_TRUE(claim);
  EXPECT_EQ(claim->a, 9);
  expect_no_violation();
}

INSTANTIATE_TEST_SUITE_P(Slots, Broadcast, ::testing::Combine(::testing::Values(0, 1), ::testing::Bool()),
                         [](const auto& tested) {
                           return std::string(std::get<0>(tested.param) == 0 ? "A" : "B") +
                                  (std::get<1>(tested.param) ? "Fd" : "Classic");
                         });

}  // namespace
}  // namespace triskin::machine
