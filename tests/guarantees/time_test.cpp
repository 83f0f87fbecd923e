// SPDX-License-Identifier: GPL-3.0-or-later
// A step of the wall clock, or a process that was stopped for a while, must freeze nothing: paces and deadlines use the
// monotonic clock. A library before the program steps the clock for it alone; the kernel's clock, and with it every
// sleep, is unchanged.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "guarantees/faulty_program.hpp"
#include "output/view/browser.hpp"
#include "support/child_process.hpp"
#include "support/strip_design.hpp"
#include "triskin/recording/recording.hpp"

namespace triskin::test {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kHour_s = 3600;

class Time : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    ::setenv("XDG_STATE_HOME", (folder_ / "state").c_str(), 1);
    design::write_design(folder_ / "strip.json", strip(4, 4));
    ASSERT_EQ(run("flash strip.json --link sim").status, 0);
  }
  [[nodiscard]] std::string stepped(const SteppedClock& clock, const std::string& arguments) const {
    return fmt::format("{} XDG_STATE_HOME='{}' {} {}", with_faults(clock.variables()), (folder_ / "state").string(),
                       program_file(), arguments);
  }
  [[nodiscard]] std::string file(const char* name) const { return fmt::format("'{}'", (folder_ / name).string()); }
  [[nodiscard]] bool has_begun(const char* name) const {
    const auto file = folder_ / name;
    return wait_until([&] { return std::filesystem::exists(file) && std::filesystem::file_size(file) > 100; });
  }
};

TEST_F(Time, the_shifted_clock_is_what_the_program_sees) {
  SteppedClock clock(folder_ / "clock");
  clock.shift(-400L * 365 * 24 * kHour_s / 10);  // The shift is 40 years.
  Running recorder(stepped(clock, "record " + file("strip.json") + " --link sim --seconds 0.5 -o " + file("r.mcap")),
                   folder_ / "log");
  ASSERT_EQ(recorder.status(), 0) << recorder.text();
  recording::Summary summary;
  std::uint64_t newest_ns = 0;
  (void)recording::read_recording(folder_ / "r.mcap",
                                  [&](const recording::ModuleSample& s) { newest_ns = s.sampled_ns; });
  EXPECT_GT(newest_ns, 0U);
  EXPECT_LT(newest_ns, 1'000'000'000ULL * 1'000'000'000ULL) << "the step did not reach the program";
}

TEST_F(Time, view_goes_on_when_the_wall_clock_steps_back_and_forth) {
  SteppedClock clock(folder_ / "clock");
  Running view(stepped(clock, "view " + file("strip.json") + " --link sim --no-open"), folder_ / "log");
  ASSERT_TRUE(view.says("/\n")) << view.text();
  LivePage page(page_address(view.text()));
  ASSERT_TRUE(page.gets_frames(5)) << view.text();
  for (const std::int64_t step_s : {-kHour_s, kHour_s, std::int64_t{0}}) {
    clock.shift(step_s);
    EXPECT_TRUE(page.gets_frames(30)) << "wall clock at " << step_s << " s";
  }
  view.signal(SIGINT);
  EXPECT_TRUE(view.ends());
  EXPECT_EQ(view.status(), 0) << view.text();
}

TEST_F(Time, live_goes_on_when_the_wall_clock_steps) {
  SteppedClock clock(folder_ / "clock");
  const ServedSimulation served((folder_ / "strip.json").string());
  Running live(stepped(clock, "live " + file("strip.json") + " --json --link " + served.link()), folder_ / "log");
  for (const std::int64_t step_s : {-kHour_s, kHour_s}) {
    const std::size_t before = live.text().size();
    clock.shift(step_s);
    EXPECT_TRUE(wait_until([&] { return live.text().size() >= before + 2000; })) << live.text().substr(0, 500);
  }
  live.signal(SIGINT);
  EXPECT_TRUE(live.ends());
  EXPECT_EQ(live.status(), 0);
}

// The sample account of a recording does not depend on the wall clock.
TEST_F(Time, record_is_complete_when_the_wall_clock_steps) {
  SteppedClock clock(folder_ / "clock");
  const ServedSimulation served((folder_ / "strip.json").string());
  Running recorder(stepped(clock, "record " + file("strip.json") + " --seconds 3 --json --link " + served.link() +
                                      " -o " + file("r.mcap")),
                   folder_ / "log");
  ASSERT_TRUE(has_begun("r.mcap")) << recorder.text();
  clock.shift(-kHour_s);
  EXPECT_TRUE(recorder.ends());
  const std::string text = recorder.text();
  const auto report = nlohmann::json::parse(text.substr(text.find('{')));
  EXPECT_GT(report["samples"].get<int>(), 100) << text;
  EXPECT_NEAR(report["seconds"].get<double>(), 3.0, 0.5);
}

TEST_F(Time, a_page_gets_frames_again_after_the_process_was_stopped) {
  SteppedClock clock(folder_ / "clock");
  Running view(stepped(clock, "view " + file("strip.json") + " --link sim --no-open"), folder_ / "log");
  ASSERT_TRUE(view.says("/\n")) << view.text();
  LivePage page(page_address(view.text()));
  ASSERT_TRUE(page.gets_frames(5));
  view.signal(SIGSTOP);
  ::sleep(3);
  view.signal(SIGCONT);
  EXPECT_TRUE(page.gets_frames(60));
  view.signal(SIGINT);
  EXPECT_TRUE(view.ends());
}

// Frames that arrive while the recorder is stopped wait in the socket or are counted as lost; nothing disappears.
TEST_F(Time, a_recorder_that_was_stopped_accounts_for_every_sample) {
  const ServedSimulation served((folder_ / "strip.json").string());
  Running recorder(line("record strip.json --seconds 5 --json --link " + served.link() + " -o r.mcap"),
                   folder_ / "log");
  ASSERT_TRUE(has_begun("r.mcap")) << recorder.text();
  recorder.signal(SIGSTOP);
  ::sleep(2);
  recorder.signal(SIGCONT);
  EXPECT_TRUE(recorder.ends());
  const std::string text = recorder.text();
  const auto report = nlohmann::json::parse(text.substr(text.find('{')));
  EXPECT_EQ(report["expected"].get<int>(), report["samples"].get<int>() + report["lost"].get<int>()) << text;
}

}  // namespace
}  // namespace triskin::test
