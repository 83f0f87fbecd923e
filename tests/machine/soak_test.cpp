// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdlib>
#include <random>
#include <set>

#include "bench.hpp"
#include "triskin/board/budget.hpp"

namespace triskin::machine {
namespace {

using wire::ModuleState;

class Soak : public Bench, public ::testing::WithParamInterface<bool> {
 protected:
  /// Minutes of virtual time: an hour on board/posix, one minute of the image in the machine, or TRISKIN_SOAK_MINUTES.
  int minutes() const {
    const char* wanted = std::getenv("TRISKIN_SOAK_MINUTES");
    return wanted == nullptr ? (on_posix ? 60 : 1) : std::max(1, std::atoi(wanted));
  }
  enum class Kind { kAbsent, kWrongId, kDip, kSda, kScl, kSaturated, kFrozen };
  static constexpr std::array kStates{ModuleState::kAbsent,    ModuleState::kWrongId, ModuleState::kLostConfiguration, ModuleState::kLineStuck,
                                      ModuleState::kLineStuck, ModuleState::kSaturated, ModuleState::kFrozen};

  void inject(Kind kind, int m) {
    SkinModule& module = module_at(m);
    switch (kind) {
      case Kind::kAbsent: module.present = false; return;
      case Kind::kWrongId: SkinLine::exchange(module, 0x0042, m); return;
      case Kind::kDip: line_of(m).dip(module, now_us()); return;
      case Kind::kSda: line_of(m).sda_held = true; return;
      case Kind::kScl: line_of(m).scl_held = true; return;
      case Kind::kSaturated: module.source.level[5] += 60'000; return;
      case Kind::kFrozen: line_of(m).freeze(module, 3, now_us()); return;
    }
  }
  void repair(Kind kind, int m) {
    SkinModule& module = module_at(m);
    module.present = true;
    module.frozen = 0;
    line_of(m).sda_held = line_of(m).scl_held = false;
    if (kind == Kind::kSaturated) module.source.level[5] -= 60'000;
    if (kind == Kind::kWrongId) SkinLine::exchange(module, scene::Ad7147::kDeviceId, m);
  }
  // A fault of 1.5 s, then time to recover; what must be in the record is noted.
  void one_fault(std::mt19937& random) {
    const auto kind = static_cast<Kind>(random() % kStates.size());
    const auto m = static_cast<int>(random() % 16);
    inject(kind, m);
    run_for((kind == Kind::kFrozen ? 4'500'000 : 1'500'000) + random() % 100'000);  // 32 readings say that a taxel is frozen
    repair(kind, m);
    const auto state = static_cast<int>(kStates[static_cast<std::size_t>(kind)]);
    const bool whole_line = kind == Kind::kSda || kind == Kind::kScl;
    for (int o = whole_line ? m % 4 : m; o < 16; o += 4) {
      injected.insert({state, o});
      if (!whole_line) break;
    }
    ++faults;
    run_for(2'300'000);
  }
  std::set<std::pair<int, int>> recorded() {
    const auto reply = request({0x19, 0x02, 0xFF});
    std::set<std::pair<int, int>> out;
    for (std::size_t k = 3; k + 4 <= reply.size(); k += 4) out.insert({reply[k] & 0xF, reply[k + 2]});
    return out;
  }
  std::set<std::pair<int, int>> injected;
  int faults = 0;
};

TEST_P(Soak, RandomFaultsLeaveNoStuckStateAndAreAllInTheRecord) {
  on_posix = GetParam();
  store_table(patch(16));
  power_up();
  run_for(1'000'000);
  std::mt19937 random(20261121);
  std::uint32_t stack_free = 0;
  const std::uint64_t until = static_cast<std::uint64_t>(minutes()) * 60'000'000;
  while (now_us() < until) {
    one_fault(random);
    frames.clear();
    for (auto& line : lines) line.bursts.clear();
    if (!on_posix && faults == 8) stack_free = budget(offsetof(board::Budget, stack_free_bytes));
  }
  run_for(2'000'000);
  const auto states = request({0x22, 0xFD, 0x03});
  ASSERT_EQ(states.size(), 3U + 16);
  for (std::size_t m = 0; m < 16; ++m) EXPECT_EQ(states[3 + m], static_cast<std::uint8_t>(ModuleState::kOk)) << m;
  const auto record = recorded();
  for (const auto& fault : injected) EXPECT_TRUE(record.contains(fault)) << "state " << fault.first << " of module " << fault.second;
  for (const auto& fault : record) EXPECT_TRUE(injected.contains(fault)) << "never injected: state " << fault.first << " of module " << fault.second;
  EXPECT_GE(injected.size(), 8U);
  std::printf("%d minutes of virtual time, %d faults, %zu different ones in the record\n", minutes(), faults, record.size());
  if (on_posix) return;
  EXPECT_GE(budget(offsetof(board::Budget, stack_free_bytes)) + 64, stack_free);
  EXPECT_EQ(machine->counts().resets, 0);
  std::printf("free stack %u then %u bytes, worst loop %u us, idle %.1f %%\n", stack_free, budget(offsetof(board::Budget, stack_free_bytes)), budget(offsetof(board::Budget, worst_loop_us)),
              100.0 * static_cast<double>(machine->counts().idle_us) / static_cast<double>(now_us()));
  expect_no_violation();
}

INSTANTIATE_TEST_SUITE_P(Boards, Soak, ::testing::Bool(), [](const auto& tested) { return std::string(tested.param ? "posix" : "machine"); });

}  // namespace
}  // namespace triskin::machine
