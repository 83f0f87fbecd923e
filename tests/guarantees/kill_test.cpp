// SPDX-License-Identifier: GPL-3.0-or-later
// A command that is ended at a random moment, with or without a chance to react, must leave files that the next one can
// use. The simulated boards are in the process, so SIGKILL is the loss of their power at the same moment.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "device/deploy/firmware_file.hpp"
#include "guarantees/faulty_program.hpp"
#include "support/strip_design.hpp"
#include "triskin/recording/recording.hpp"

namespace triskin::test {
namespace {

constexpr std::uint64_t kSeed = 20261125;
constexpr std::array<int, 3> kSignals{SIGINT, SIGTERM, SIGKILL};

class Kills : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    design::write_design(folder_ / "strip.json", strip(8, 4));
    const std::vector<std::uint8_t> package = package_bytes({.size_bytes = 16'384, .version = 0x01000000});
    std::ofstream(folder_ / "new.tsk", std::ios::binary)
        .write(reinterpret_cast<const char*>(package.data()), static_cast<std::streamsize>(package.size()));
  }
  // Returns the microseconds that an undisturbed command takes.
  [[nodiscard]] useconds_t duration_us(const std::string& command) const {
    const auto start = std::chrono::steady_clock::now();
    const Outcome o = run(command);
    EXPECT_EQ(o.status, 0) << command << o.messages;
    return static_cast<useconds_t>(
        std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start).count());
  }
  // Starts a command and ends it at a random moment of `within_us` by a random signal, which it returns.
  int kill_at_random(const std::string& command, useconds_t within_us) {
    Running program(line(command), folder_ / "log");
    ::usleep(static_cast<useconds_t>(random_() % std::max<useconds_t>(within_us, 1)));
    const int signal = kSignals[random_() % kSignals.size()];
    program.signal(signal);
    EXPECT_TRUE(program.ends()) << command << " is deaf to signal " << signal;
    return signal;
  }
  void expect_works(const std::string& command, const std::string& after, int round) const {
    const Outcome o = run(command);
    EXPECT_EQ(o.status, 0) << command << " after " << after << ", seed " << kSeed << ", round " << round << "\n"
                           << o.out << o.messages;
  }

  void rounds(int each) {
    const std::string flash = "flash strip.json --link sim", update = flash + " --firmware new.tsk --force";
    const std::string record = "record strip.json --link sim --seconds 20 -o r.mcap";
    const useconds_t flash_us = duration_us(flash), update_us = duration_us(update), record_us = duration_us(record);
    for (int round = 0; round < each; ++round) {
      std::filesystem::remove_all(folder_ / "state");
      (void)kill_at_random(flash, flash_us);
      expect_whole_tables(round);
      expect_works(flash, "an ended flash", round);
      expect_works("verify strip.json --link sim", "an ended flash", round);

      (void)kill_at_random(update, update_us);
      expect_works(flash, "an ended update", round);
      expect_works(update, "an ended update", round);

      const std::string before = read_file(folder_ / "r.mcap");
      const int signal = kill_at_random(record, record_us);
      check_recording(before, signal, round);
      expect_works("record strip.json --link sim --seconds 0.2 -o again.mcap", "an ended recording", round);

      (void)kill_at_random("view strip.json --link sim --no-open", 300'000);
      Running view(line("view strip.json --link sim --no-open"), folder_ / "log");
      EXPECT_TRUE(view.says("http://")) << "after an ended view, round " << round;
      view.signal(SIGINT);
      EXPECT_TRUE(view.ends());
      EXPECT_EQ(view.status(), 0);
    }
  }
  // Each controller must have no table or the complete new one; half of it would be a different table.
  void expect_whole_tables(int round) const {
    const Outcome o = run("verify strip.json --link sim --no-touch --json");
    ASSERT_LE(o.status, 1) << o.messages << "round " << round;
    const auto report = nlohmann::json::parse(o.out);
    for (const auto& finding : report.at("findings"))
      EXPECT_EQ(finding["kind"], "not_flashed") << "round " << round << "\n" << finding;
  }
  // The file is the old recording, or the new one: complete where the program could end it, else it can be recovered
  // as soon as a chunk was in it.
  void check_recording(const std::string& before, int signal, int round) const {
    const std::string now = read_file(folder_ / "r.mcap");
    if (now == before) return;
    EXPECT_THAT(now, testing::StartsWith("\x89MCAP0\r\n")) << "round " << round;
    const Outcome o = run("recover r.mcap");
    EXPECT_TRUE(o.status == 0 || signal == SIGKILL) << o.messages << "round " << round;
    if (o.status != 0) {
      EXPECT_THAT(o.messages, testing::HasSubstr("holds no whole chunk"));
      return;
    }
    EXPECT_TRUE(recording::read_recording(folder_ / "r.mcap", [](const recording::ModuleSample&) {}).file.complete);
  }

  std::mt19937_64 random_{kSeed};
};

// Each round kills the program at four moments, one in each command. TRISKIN_KILLS sets a higher number of rounds.
TEST_F(Kills, thirty_two_moments_and_the_next_command_works) {
  const char* moments = std::getenv("TRISKIN_KILLS");
  rounds(moments == nullptr ? 8 : std::max(1, std::atoi(moments) / 4));
}

TEST_F(Kills, three_hundred_moments_and_the_next_command_works) {
  rounds(75);
}

}  // namespace
}  // namespace triskin::test
