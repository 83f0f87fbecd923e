// SPDX-License-Identifier: GPL-3.0-or-later
// Tests each failure of a strapped module, on each of sixteen: it must be named right, and the others must keep their
// rate. On board/posix there is one at a time, in the machine one on each line at once.
#include <algorithm>

#include "failure.hpp"
#include "sampling_bench.hpp"

namespace triskin::machine {
namespace {

using wire::ModuleState;
constexpr std::uint64_t kSequence_us = 9'200;

class Failures : public Sampling, public ::testing::WithParamInterface<bool> {
 protected:
  void begin() {
    on_posix = GetParam();
    start(16, {wire::Decimation::k64, 1});
    run_for(1'500'000);  // Every chip's clock is known by now, and the chips have drifted apart.
  }

  void expect_named(Failure f, const std::vector<int>& broken, std::uint64_t took_us, bool tested) {
    std::vector<int> doubled;  // These are the places to which a moved module came.
    for (const int m : broken) {
      if (f == Failure::kMoved) doubled.push_back((m + 4) % 16);
    }
    const auto by_module = samples();
    for (const auto& [m, list] : by_module) {
      const bool is_broken = std::ranges::count(broken, m) > 0, is_doubled = std::ranges::count(doubled, m) > 0;
      const ModuleState expected = is_doubled ? ModuleState::kDuplicate : is_broken ? state_of(f) : ModuleState::kOk;
      const auto named = std::ranges::count(list, expected, &wire::TaxelFrame::state);
      if (is_broken || is_doubled) {
        EXPECT_GE(named, 1) << "failure " << static_cast<int>(f) << " of module " << m;
        for (const auto& t : list) {
          // A second chip spoils the mark of the first one, before both are compared. A self-test looks for all anew.
          const bool fine = t.state == expected || t.state == ModuleState::kOk ||
                            (is_doubled && !tested && t.state == ModuleState::kLostConfiguration) ||
                            (tested && t.state == ModuleState::kUnknown);
          EXPECT_TRUE(fine) << "failure " << static_cast<int>(f) << " of module " << m << " called "
                            << static_cast<int>(t.state);
        }
      } else {
        EXPECT_GE(static_cast<double>(named), 0.95 * static_cast<double>(took_us / kSequence_us))
            << "failure " << static_cast<int>(f) << " elsewhere, module " << m;
        EXPECT_EQ(named, static_cast<long>(list.size()))
            << "failure " << static_cast<int>(f) << " elsewhere, module " << m;
      }
    }
    EXPECT_EQ(by_module.size(), 16U);
  }

  // Someone may ask for a self-test when the failure is there and when it is gone; nothing must depend on it.
  void one(Failure f, const std::vector<int>& broken, bool tested = false) {
    for (const int m : broken) inject(f, line_of(m), m, now_us());
    if (tested) self_test();
    if (f == Failure::kMoved) run_for(250'000);  // Two chips are compared with each other's offsets.
    frames.clear();
    const std::uint64_t window_us = f == Failure::kFrozen || f == Failure::kMoved ? 600'000 : 400'000;
    run_for(window_us);
    expect_named(f, broken, window_us, tested);
    for (const int m : broken) repair(f, line_of(m), m);
    if (tested) self_test();
    run_for(f == Failure::kMoved ? 1'800'000 : 300'000);
    frames.clear();
    run_for(50'000);
    for (const auto& [m, list] : samples())
      EXPECT_EQ(list.back().state, ModuleState::kOk) << "after failure " << static_cast<int>(f) << ", module " << m;
  }

  void each(Failure f, bool tested) {
    for (int m = 0; on_posix && m < layout::kMaxModules; ++m) one(f, {m}, tested);
    for (int turn = 0; !on_posix && turn < 4; ++turn) {
      std::vector<int> broken;
      for (int line = 0; line < layout::kLines; ++line) broken.push_back(line + 4 * ((line + turn) % 4));
      one(f, broken, tested);
    }
  }
};

TEST_P(Failures, EachOnEachOfSixteenModulesIsNamedAndTheOthersGoOn) {
  begin();
  for (const Failure f : kAllFailures) {
    if (holds_line(f)) continue;  // A later test covers these failures.
    each(f, false);
  }
  if (!on_posix) expect_no_violation();
}

// A self-test finds, configures and compares every chip anew: what it sees of two at one address is the same.
TEST_P(Failures, AModuleAtAnothersAddressIsNamedBySelfTestToo) {
  begin();
  each(Failure::kMoved, true);
  if (!on_posix) expect_no_violation();
}

// All four modules of the line get this state, and the other lines are not affected.
TEST_P(Failures, EachStuckLineIsNamedAndTheOthersGoOn) {
  begin();
  for (int line = 0; line < layout::kLines; ++line) {
    for (const Failure f : {Failure::kSda, Failure::kScl}) {
      inject(f, line_of(line), line, now_us());
      run_for(50'000);
      frames.clear();
      constexpr std::uint64_t kWindow_us = 500'000;
      run_for(kWindow_us);
      for (const auto& [m, list] : samples()) {
        const ModuleState expected = m % 4 == line ? state_of(f) : ModuleState::kOk;
        for (const auto& t : list) EXPECT_EQ(t.state, expected) << m;
        EXPECT_GE(static_cast<double>(list.size()), 0.95 * static_cast<double>(kWindow_us / kSequence_us)) << m;
      }
      EXPECT_EQ(samples().size(), 16U);
      repair(f, line_of(line), line);
      run_for(1'500'000);
      frames.clear();
      run_for(50'000);
      for (const auto& [m, list] : samples()) EXPECT_EQ(list.back().state, ModuleState::kOk) << m;
    }
  }
  if (!on_posix) expect_no_violation();
}

TEST_P(Failures, LineHeldByAChipIsFreedByPulses) {
  begin();
  lines[1].frees_after_pulses = lines[1].pulses + 5;
  lines[1].sda_held = true;
  run_for(400'000);
  frames.clear();
  run_for(50'000);
  EXPECT_EQ(samples().at(1).back().valid, layout::kAllTaxels);
  EXPECT_FALSE(lines[1].sda_held);
}

INSTANTIATE_TEST_SUITE_P(Boards, Failures, ::testing::Bool(),
                         [](const auto& tested) { return std::string(tested.param ? "posix" : "machine"); });

}  // namespace
}  // namespace triskin::machine
