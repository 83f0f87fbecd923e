// SPDX-License-Identifier: GPL-3.0-or-later
// A simulation in the process runs faster than real time. Commands without an end must follow the user's clock and wait
// for the next sample without keeping a core busy.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <chrono>

#include "guarantees/faulty_program.hpp"
#include "support/strip_design.hpp"
#include "triskin/design/design.hpp"

namespace triskin::test {
namespace {

class Pacing : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    design::write_design(folder_ / "strip.json", strip(4, 4));
    ASSERT_EQ(run("flash strip.json --link sim").status, 0);
  }
  // The time includes all child programs that have been waited for.
  static double processor_s() {
    rusage usage{};
    ::getrusage(RUSAGE_CHILDREN, &usage);
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
  }
};

// Both limits are ratios to the duration of this run, which is longer on a loaded machine.
TEST_F(Pacing, a_dump_without_an_end_does_not_spin_a_core) {
  const double before_s = processor_s();
  const auto start = std::chrono::steady_clock::now();
  Running dump(line("dump strip.json --link sim --ask"), folder_ / "log");
  ASSERT_TRUE(dump.says("claim"));
  ::usleep(1'500'000);
  dump.signal(SIGINT);
  EXPECT_TRUE(dump.ends());
  EXPECT_EQ(dump.status(), 0) << dump.text();
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_LT(processor_s() - before_s, 0.5 * took_s);
}

TEST_F(Pacing, live_without_an_end_does_not_run_ahead_of_the_clock) {
  const auto start = std::chrono::steady_clock::now();
  Running live(line("live strip.json --link sim --json"), folder_ / "log");
  ASSERT_TRUE(live.says("time_s"));
  ::usleep(1'000'000);
  live.signal(SIGINT);
  EXPECT_TRUE(live.ends());
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::string text = live.text();
  const std::size_t at = text.rfind("\"time_s\":");
  ASSERT_NE(at, std::string::npos);
  constexpr double kLine_s = 0.2;  // Virtual time advances by one line at a time.
  EXPECT_LE(std::stod(text.substr(at + 9)), took_s + kLine_s) << text;
}

}  // namespace
}  // namespace triskin::test
