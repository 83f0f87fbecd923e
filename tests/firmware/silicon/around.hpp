// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "triskin/machine/peripheral.hpp"

namespace triskin::machine {

/// Surrounds a single block in a test: time that the test passes, and the violations that the block reports.
class Around final : public Surroundings {
 public:
  explicit Around(std::uint64_t sysclk_hz = 170'000'000) : sysclk_hz_(sysclk_hz) {}
  Scheduler& time() override { return time_; }
  void set_irq(int, bool) override {}
  void violation(std::string what) override { violations.push_back(std::move(what)); }
  [[nodiscard]] std::uint64_t sysclk_hz() const override { return sysclk_hz_; }
  void request_reset(std::uint32_t) override {}
  void raise_nmi() override {}
  void pass(Time by) {
    time_.advance(by);
    time_.run_due();
  }
  /// Expects exactly one violation with this text.
  void expect(const char* part) const {
    ASSERT_EQ(violations.size(), 1U) << part;
    EXPECT_NE(violations[0].find(part), std::string::npos) << violations[0];
  }
  std::vector<std::string> violations;

 private:
  Scheduler time_;
  std::uint64_t sysclk_hz_;
};

}  // namespace triskin::machine
