// SPDX-License-Identifier: GPL-3.0-or-later
// A step of the wall clock, or a process that was stopped for a while, must freeze nothing: paces and deadlines use the
// monotonic clock. A library before the program steps the clock for it alone; the kernel's clock, and with it every
// sleep, is unchanged.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "guarantees/faulty_program.hpp"
#include "support/child_process.hpp"
#include "support/strip_design.hpp"
#include "triskin/recording/recording.hpp"
#include "view/browser.hpp"

namespace triskin::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr std::int64_t kHour_s = 3600;

// Reads the live skin like a page in a browser.
class Page {
 public:
  // `address` is "http://127.0.0.1:PORT/TOKEN/".
  explicit Page(const std::string& address)
      : host_(address.substr(7, address.find('/', 7) - 7)),
        client_(static_cast<std::uint16_t>(std::stoi(host_.substr(host_.find(':') + 1)))) {
    client_.send(
        fmt::format("GET {}live HTTP/1.1\r\nHost: {}\r\nOrigin: http://{}\r\nUpgrade: websocket\r\nConnection: "
                    "Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
                    address.substr(address.find('/', 7)), host_, host_));
    EXPECT_THAT(client_.read_to("\r\n\r\n"), StartsWith("HTTP/1.1 101"));
  }
  // Reads messages until `count` frames with samples have arrived; returns false if five seconds passed without a byte.
  bool gets_frames(int count) {
    while (count > 0) {
      const std::string head = client_.read(2);
      if (head.size() < 2) return false;
      std::size_t size = static_cast<unsigned char>(head[1]);
      const std::size_t more = size == 126 ? 2 : size == 127 ? 8 : 0;
      if (more > 0) size = 0;
      for (const char c : client_.read(more)) size = size << 8 | static_cast<unsigned char>(c);
      if (client_.read(size).size() < size) return false;
      if ((static_cast<unsigned char>(head[0]) & 0xF) == 2) --count;  // A binary message is a frame.
    }
    return true;
  }

 private:
  std::string host_;
  RawClient client_;
};

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
  // Finds the address that view prints.
  static std::string address_in(const std::string& text) {
    const std::size_t at = text.find("http://");
    return at == std::string::npos ? "" : text.substr(at, text.find_first_of("\r\n", at) - at);
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
  Page page(address_in(view.text()));
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
  Page page(address_in(view.text()));
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
