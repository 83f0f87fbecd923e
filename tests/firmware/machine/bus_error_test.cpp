// SPDX-License-Identifier: GPL-3.0-or-later
// Spurious bus errors (errata ES0430, 2.15.2) occur at random moments on all lines while sixteen modules stream: they
// must be cleared and counted, without any other effect.
#include <cstdlib>

#include "sampling_bench.hpp"
#include "triskin/board/budget.hpp"

namespace triskin::machine {
namespace {

constexpr double kPerHour = 10'000;
constexpr std::uint64_t kMinute_us = 60'000'000;

class BusErrors : public Sampling {
 protected:
  /// Returns the minutes of virtual time: one, or TRISKIN_BUS_ERROR_MINUTES. The errors of an hour occur in each.
  static int minutes() {
    const char* wanted = std::getenv("TRISKIN_BUS_ERROR_MINUTES");
    return wanted == nullptr ? 1 : std::max(1, std::atoi(wanted));
  }
};

TEST_F(BusErrors, AreClearedAndCountedAndNothingIsLost) {
  disturbances.bus_errors = minutes() >= 60 ? kPerHour * 1.05 : kPerHour * 60 / minutes();
  // The sequence is the shortest, or the firmware's own in a long run.
  start(16, {minutes() < 10 ? wire::Decimation::k64 : wire::Decimation::k256, 1});
  run_for(1'000'000);
  const std::uint64_t begin_us = now_us();
  std::array<std::uint64_t, 16> readings{};
  for (int k = 0; k < 10 * minutes(); ++k) {
    frames.clear();
    for (SkinLine& line : lines) line.bursts.clear();
    run_for(kMinute_us / 10);
    for (const auto& [m, list] : samples()) {
      for (const auto& t : list) ASSERT_EQ(t.state, wire::ModuleState::kOk) << m;
      readings[static_cast<std::size_t>(m)] += list.size();
    }
  }
  const std::uint64_t errors = machine->counts().spurious_bus_errors;
  const double sequences =
      static_cast<double>(now_us() - begin_us) / static_cast<double>(module_at(0).chip->sequence_us());
  for (int m = 0; m < 16; ++m)
    EXPECT_GE(static_cast<double>(readings[static_cast<std::size_t>(m)]), 0.99 * sequences) << m;
  EXPECT_GE(errors, 9'500U);
  EXPECT_EQ(budget(offsetof(board::Budget, bus_errors)), errors);
  EXPECT_EQ(request({0x19, 0x02, 0xFF}).size(), 3U) << "a fault was recorded";
  for (const SkinLine& line : lines) EXPECT_EQ(line.pulses, 0) << "a line was taken for stuck";
  std::printf("%llu spurious bus errors in %d minutes of virtual time, all counted, no fault recorded\n",
              static_cast<unsigned long long>(errors), minutes());
  expect_no_violation();
}

}  // namespace
}  // namespace triskin::machine
