// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>
#include <set>

#include "bench.hpp"
#include "triskin/board/budget.hpp"

namespace triskin::machine {
namespace {

using wire::ModuleState;

/// Minutes of virtual time; an hour takes about as long on a computer: TRISKIN_SOAK_MINUTES=60.
int minutes() {
  const char* wanted = std::getenv("TRISKIN_SOAK_MINUTES");
  return wanted == nullptr ? 1 : std::max(1, std::atoi(wanted));
}

class Soak : public Bench {
 protected:
  // Injects a fault for 1.5 s, notes what must be in the record, repairs it.
  void one_fault(std::mt19937& random) {
    const auto m = static_cast<std::size_t>(random() % 16);
    TestLine& line = lines[m % 4];
    TestLine::Chip& chip = line.chips[m / 4];
    const auto kind = random() % 4;
    if (kind == 0) chip.present = false;
    if (kind == 1) chip = {true, 0x0042, {}, 0};
    if (kind == 2) chip.regs = {};
    if (kind == 3) line.sda_held = true;
    run_for(1'500'000);
    chip.present = true;
    if (kind == 1) chip = {};
    line.sda_held = false;
    constexpr std::array kStates{ModuleState::kAbsent, ModuleState::kWrongId, ModuleState::kLostConfiguration, ModuleState::kLineStuck};
    const auto state = static_cast<int>(kStates[kind]);
    if (kind != 3) injected.insert({state, static_cast<int>(m)});
    for (int o = static_cast<int>(m % 4); kind == 3 && o < 16; o += 4) injected.insert({state, o});
    run_for(2'500'000);
  }
  std::set<std::pair<int, int>> recorded() {
    const auto reply = request({0x19, 0x02, 0xFF});
    std::set<std::pair<int, int>> out;
    for (std::size_t k = 3; k + 4 <= reply.size(); k += 4) out.insert({reply[k] & 0xF, reply[k + 2]});
    return out;
  }
  std::set<std::pair<int, int>> injected;
};

TEST_F(Soak, RandomFaultsLeaveNoStuckStateAndAreAllInTheRecord) {
  store_table(patch(16));
  power_up();
  run_for(1'000'000);
  std::mt19937 random(20261121);
  std::uint32_t stack_free = 0;
  for (int k = 0; k < 15 * minutes(); ++k) {
    one_fault(random);
    if (k == 5) stack_free = budget(offsetof(board::Budget, stack_free_bytes));
  }
  run_for(2'000'000);
  const auto states = request({0x22, 0xFD, 0x03});
  ASSERT_EQ(states.size(), 3U + 16);
  for (std::size_t m = 0; m < 16; ++m) EXPECT_EQ(states[3 + m], static_cast<std::uint8_t>(ModuleState::kOk)) << m;
  const auto record = recorded();
  for (const auto& fault : injected) EXPECT_TRUE(record.contains(fault)) << "state " << fault.first << " of module " << fault.second;
  EXPECT_GE(injected.size(), 10U);
  EXPECT_GE(budget(offsetof(board::Budget, stack_free_bytes)) + 64, stack_free);
  EXPECT_EQ(machine->counts().resets, 0);
  expect_no_violation();
}

}  // namespace
}  // namespace triskin::machine
