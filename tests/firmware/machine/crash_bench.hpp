// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "sampling_bench.hpp"

namespace triskin::machine {

/// Makes an image fail while it works, by replacing instructions of the sampler.
class CrashBench : public Sampling {
 protected:
  static constexpr const char* kStep = "_ZN7triskin2fw11LineSampler4stepEy";
  void start_work() {
    store_table(patch(4));
    power_up();
    run_for(300'000);
    ASSERT_TRUE(health().has_value());
  }
  [[nodiscard]] std::uint32_t address_of(const char* symbol) const { return application.symbols.at(symbol) & ~1U; }
  /// The next call of the sampler runs these instructions instead.
  void overwrite(std::uint32_t first, std::uint32_t second) {
    const std::uint32_t at = address_of(kStep);
    ASSERT_EQ(at % 4, 0U) << "the test writes whole words";
    machine->write_word(at, first);
    machine->write_word(at + 4, second);
  }
  static constexpr std::uint32_t kUndefined = 0xDE01DE00, kForEver = 0xE7FEE7FE;
  // The instructions are push {r0, lr} and bl to itself.
  static constexpr std::uint32_t kRecursion[2] = {0xF7FFB501, 0xE7FEFFFD};
};

}  // namespace triskin::machine
