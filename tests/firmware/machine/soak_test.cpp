// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdlib>
#include <fstream>
#include <random>
#include <set>

#include "bench.hpp"
#include "failure.hpp"
#include "triskin/board/budget.hpp"
#include "triskin/core/bytes.hpp"
#include "triskin/wire/loader_protocol.hpp"

namespace triskin::machine {
namespace {

using wire::ModuleState;

class Soak : public Bench, public ::testing::WithParamInterface<bool> {
 protected:
  /// Returns the minutes of virtual time: an hour on board/posix, five minutes of the image in the machine, or
  /// TRISKIN_SOAK_MINUTES.
  int minutes() const {
    const char* wanted = std::getenv("TRISKIN_SOAK_MINUTES");
    return wanted == nullptr ? (on_posix ? 60 : 5) : std::max(1, std::atoi(wanted));
  }
  // Makes one failure of 1.5 s, then leaves time to recover. The record must have exactly this failure, with the time
  // of its first moment.
  void one_fault(std::mt19937& random) {
    const Failure failure = kAllFailures[random() % kAllFailures.size()];
    const auto m = static_cast<int>(random() % 16);
    const std::uint64_t from_us = now_us();
    inject(failure, line_of(m), m, from_us);
    if (failure == Failure::kMoved) self_test();
    run_for((failure == Failure::kFrozen ? 4'500'000 : 1'500'000) +
            random() % 100'000);  // After 65 readings a taxel is called frozen.
    const std::uint64_t to_us = now_us();
    repair(failure, line_of(m), m);
    if (failure == Failure::kMoved) self_test();
    run_for(2'300'000);
    const auto expected = expected_record(failure, m);
    const auto record = recorded();
    EXPECT_EQ(record, expected) << "failure " << static_cast<int>(failure) << " of module " << m << " at " << from_us
                                << " us";
    for (const auto& [state, module] : record) {
      const std::uint64_t first_us = first_ms(state, module) * 1000;
      EXPECT_TRUE(first_us + kBoot_us >= from_us && first_us <= to_us)
          << "state " << state << " of module " << module << " noted at " << first_us << " us, was there from "
          << from_us << " to " << to_us;
    }
    ASSERT_EQ(request({0x14, 0xFF, 0xFF, 0xFF}), std::vector<std::uint8_t>{0x54});
    different.insert(record.begin(), record.end());
    ++faults;
  }
  /// Returns state and row of the table for every fault that the failure leaves.
  static std::set<std::pair<int, int>> expected_record(Failure failure, int m) {
    std::set<std::pair<int, int>> out;
    const int state = static_cast<int>(state_of(failure));
    if (!holds_line(failure)) out.insert({state, m});
    for (int o = m % layout::kLines; holds_line(failure) && o < layout::kMaxModules; o += layout::kLines)
      out.insert({state, o});
    if (failure == Failure::kMoved)
      out.insert({static_cast<int>(ModuleState::kDuplicate), (m + layout::kLines) % layout::kMaxModules});
    return out;
  }
  std::set<std::pair<int, int>> recorded() {
    const auto reply = request({0x19, 0x02, 0xFF});
    std::set<std::pair<int, int>> out;
    for (std::size_t k = 3; k + 4 <= reply.size(); k += 4) {
      EXPECT_EQ(reply[k + 3], kConfirmedOnly) << "a repaired fault is no longer there";
      out.insert({reply[k] & 0xF, reply[k + 2]});
    }
    return out;
  }
  /// Returns when a fault was first seen, since power-up.
  std::uint64_t first_ms(int state, int module) {
    const auto reply =
        request({0x19, 0x04, static_cast<std::uint8_t>(0x90 | state), 0, static_cast<std::uint8_t>(module), 0x01});
    if (reply.size() < 14) {
      ADD_FAILURE() << "no freeze data";
      return 0;
    }
    return ByteReader(Bytes(reply).subspan(10)).le32();
  }
  /// Returns the maximum stack need that the build found (tools/check_stack.py).
  std::uint32_t max_stack_bytes() const {
    std::uint32_t bytes = 0;
    std::ifstream(firmware(running_slot == 0 ? "triskin_app_a.elf.stack" : "triskin_app_b.elf.stack")) >> bytes;
    EXPECT_GT(bytes, 0U) << "the build left no bound of the stack";
    return bytes;
  }
  static constexpr std::uint8_t kConfirmedOnly = 0x08;
  /// The application's clock starts at most this late: the loader's window, its check of an image that fills the 80 KB
  /// of the application (0.2 ms per KB), and 3 ms in which the crystal starts and is measured.
  static constexpr std::uint64_t kBoot_us = wire::loader::kWindow_us + 80 * 200 + 3'000;
  std::set<std::pair<int, int>> different;
  int faults = 0;
};

TEST_P(Soak, RandomFaultsLeaveNoStuckStateAndAreAllInTheRecord) {
  on_posix = GetParam();
  constexpr double kPerHour = 1'200;  // Each kind occurs every three seconds.
  disturbances = {kPerHour, kPerHour, kPerHour, kPerHour, kPerHour};
  store_table(patch(16));
  power_up();
  run_for(1'000'000);
  std::mt19937 random(20261121);
  const std::uint64_t until = static_cast<std::uint64_t>(minutes()) * 60'000'000;
  while (now_us() < until) {
    one_fault(random);
    frames.clear();
    for (auto& line : lines) line.bursts.clear();
  }
  run_for(2'000'000);
  const auto states = request({0x22, 0xFD, 0x03});
  ASSERT_EQ(states.size(), 3U + 16);
  for (std::size_t m = 0; m < layout::kMaxModules; ++m)
    EXPECT_EQ(states[3 + m], static_cast<std::uint8_t>(ModuleState::kOk)) << m;
  EXPECT_GE(different.size(), 8U);
  std::printf("%d minutes of virtual time, %d faults, each in the record with its time; %zu different entries\n",
              minutes(), faults, different.size());
  if (on_posix) return;
  const std::uint32_t reserved =
      application.symbols.at("triskin_stack_top") - application.symbols.at("triskin_stack_bottom");
  const std::uint32_t used = reserved - budget(offsetof(board::Budget, stack_free_bytes)), most = max_stack_bytes();
  EXPECT_LE(used, most);
  EXPECT_EQ(machine->counts().resets, 0);
  std::printf("stack %u of at most %u bytes, worst loop %u us, idle %.1f %%\n", used, most,
              budget(offsetof(board::Budget, worst_loop_us)),
              100.0 * static_cast<double>(machine->counts().idle_us) / static_cast<double>(now_us()));
  expect_no_violation();
}

INSTANTIATE_TEST_SUITE_P(Boards, Soak, ::testing::Bool(),
                         [](const auto& tested) { return std::string(tested.param ? "posix" : "machine"); });

}  // namespace
}  // namespace triskin::machine
