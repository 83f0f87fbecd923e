// SPDX-License-Identifier: GPL-3.0-or-later
// `triskin discover --elf` and `triskin verify --elf` must name what stops a board, with function and line.
#include "crash_bench.hpp"
#include "machine_link.hpp"
#include "triskin/base/error.hpp"
#include "triskin/diagnose/board_report.hpp"
#include "triskin/session/bus.hpp"

namespace triskin::machine {
namespace {

class NamedCrashes : public CrashBench {
 protected:
  [[nodiscard]] std::filesystem::path elf() const {
    return firmware(running_slot == 0 ? "triskin_app_a.elf" : "triskin_app_b.elf");
  }
  /// Returns all remarks of a host about the board, one per line.
  std::string remarks() {
    MachineLink link({[this](const wire::CanFrame& f) { deliver(f); }, [this](std::uint64_t us) { run_for(us); },
                      [this] { return now_us(); }, &frames, [this] { return machine->frames_waiting(); }},
                     true);
    session::Bus bus(link);
    session::Controller controller(bus, 1);
    std::string text;
    for (const std::string& remark : diagnose::board_remarks(diagnose::report_board(controller), elf()))
      text += remark + "\n";
    return text;
  }
  void expect_named(const std::string& text, std::string_view cause) const {
    EXPECT_NE(text.find(cause), std::string::npos) << text;
    EXPECT_NE(text.find("LineSampler::step"), std::string::npos) << text;
    EXPECT_NE(text.find("sampler.cpp:"), std::string::npos) << text;
  }
};

TEST_F(NamedCrashes, HardFault) {
  start_work();
  EXPECT_EQ(remarks(), "");
  overwrite(kUndefined, kUndefined);
  run_for(300'000);
  const std::string text = remarks();
  expect_named(text, "was stopped by a fault of the processor");
  std::printf("%s", text.c_str());
}

TEST_F(NamedCrashes, Watchdog) {
  start_work();
  overwrite(kForEver, kForEver);
  run_for(2'500'000);
  const std::string text = remarks();
  expect_named(text, "was stopped by the watchdog");
  std::printf("%s", text.c_str());
}

TEST_F(NamedCrashes, StackOverflow) {
  start_work();
  overwrite(kRecursion[0], kRecursion[1]);
  run_for(300'000);
  const std::string text = remarks();
  expect_named(text, "was stopped by a stack overflow");
  std::printf("%s", text.c_str());
}

TEST_F(NamedCrashes, BusOff) {
  disturbances.can_errors = 3.6e6;  // One error occurs per millisecond.
  store_table(patch(16));
  power_up();
  run_for(300'000);
  for (int k = 0; k < 20; ++k) (void)request({0x22, 0xFD, 0x10}, 50'000);
  ASSERT_GE(machine->counts().bus_offs, 1U);
  std::string text;
  for (int tries = 0; text.empty() && tries < 20; ++tries) {
    try {
      text = remarks();
    } catch (const Error&) {
      run_for(50'000);  // The bus is as bad as before.
    }
  }
  EXPECT_NE(text.find("(bus-off): check termination"), std::string::npos) << text;
  EXPECT_EQ(text.find("was stopped"), std::string::npos) << text;
  std::printf("%s", text.c_str());
}

// The RAM is lost with the power, but the fault memory is not, until it is cleared.
TEST_F(NamedCrashes, CrashOutlivesThePower) {
  start_work();
  overwrite(kUndefined, kUndefined);
  run_for(300'000);
  const auto before = crash();
  ASSERT_TRUE(before.has_value());
  power_up();
  run_for(300'000);
  EXPECT_EQ(crash(), before);
  EXPECT_EQ(health().value().crashes_in_row, 0);
  expect_named(remarks(), "was stopped by a fault of the processor");
  ASSERT_EQ(request({0x14, 0xFF, 0xFF, 0xFF}).at(0), 0x54);
  EXPECT_FALSE(crash().has_value());
  power_up();
  run_for(300'000);
  EXPECT_FALSE(crash().has_value());
  expect_no_violation();
}

// `verify` clears a crash when it has named it.
TEST_F(NamedCrashes, TextsNameWhatIsKnown) {
  wire::Crash c;
  c.cause = wire::CrashCause::kWatchdog;
  c.uptime_ms = 2500;
  EXPECT_EQ(diagnose::crash_text(c), "was stopped by the watchdog: its loop did not come round after 2.5 s");
  c.pc = application.symbols.at(kStep) & ~1U;
  const std::string named = diagnose::crash_text(c, elf());
  EXPECT_NE(named.find("LineSampler::step"), std::string::npos) << named;
  char address[16];
  std::snprintf(address, sizeof address, "@%08x", static_cast<unsigned>(c.pc));
  const std::string line = diagnose::name_places("at " + std::string(address) + ", then", elf());
  EXPECT_TRUE(line.starts_with("at triskin::fw::LineSampler::step")) << line;
  EXPECT_TRUE(line.ends_with("), then")) << line;
  EXPECT_EQ(diagnose::name_places("no address @here", elf()), "no address @here");
  EXPECT_THROW((void)diagnose::name_places("at @08004000", "/no/such.elf"), InputError);
}

}  // namespace
}  // namespace triskin::machine
