// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the log of the image: on the serial port of the ST-LINK, and the same lines as frames over CAN and USB.
#include "triskin/wire/log.hpp"

#include <fstream>
#include <iomanip>
#include <sstream>

#include "sampling_bench.hpp"
#include "triskin/board/budget.hpp"
#include "usb_stream.hpp"

namespace triskin::machine {
namespace {

std::vector<std::string> lines_of(const std::vector<wire::CanFrame>& frames) {
  wire::LogDecoder decoder;
  std::vector<std::string> lines;
  for (const wire::CanFrame& f : frames) {
    if (const auto line = decoder.add(f)) lines.emplace_back(line->view());
  }
  return lines;
}

// Returns the texts behind time and level.
std::vector<std::string> terminal_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line.back() != '\r') continue;  // Its end has not left the port yet.
    line.pop_back();
    line = line.substr(12);
    for (const char* level : {"error: ", "warning: "}) {
      if (line.starts_with(level)) line = line.substr(std::string_view(level).size());
    }
    lines.push_back(line);
  }
  return lines;
}

bool says(const std::vector<std::string>& lines, std::string_view part) {
  return std::ranges::any_of(lines, [&](const std::string& l) { return l.find(part) != std::string::npos; });
}

class Logs : public Sampling {
 protected:
  void ask_for_log(wire::LogLevel level) {
    unlock();
    ASSERT_EQ(request({0x2E, 0xFD, 0x13, static_cast<std::uint8_t>(level), 0}).at(0), 0x6E);
  }
};

TEST_F(Logs, SerialPortAndFramesHaveTheSameLines) {
  store_table(patch(4));
  power_up();
  run_for(300'000);
  module_at(2).present = false;
  run_for(300'000);
  ask_for_log(wire::LogLevel::kInformation);
  run_for(300'000);
  module_at(2).present = true;
  run_for(500'000);
  const auto serial = terminal_lines(machine->serial_text()), over_can = lines_of(frames);
  EXPECT_TRUE(says(serial, "started: firmware "));
  EXPECT_TRUE(says(serial, "crystal 8 MHz"));
  EXPECT_TRUE(says(serial, "table 1: 4 modules, node address 1"));
  EXPECT_TRUE(says(serial, "module in row 2: absent"));
  EXPECT_TRUE(says(serial, "module in row 2: works"));
  EXPECT_EQ(serial, over_can) << machine->serial_text();
  expect_no_violation();
}

// Lines arrive over USB at the program that asks there, and not over CAN.
TEST_F(Logs, UsbGetsTheLinesWhenItAsks) {
  store_table(patch(4));
  power_up();
  run_for(300'000);
  UsbStream usb(*machine);
  ASSERT_TRUE(usb.open());
  ASSERT_TRUE(usb.unlock_and_stream());
  std::vector<wire::CanFrame> others;
  ASSERT_EQ(usb.ask({0x2E, 0xFD, 0x13, 3, 0}, others).at(0), 0x6E);
  for (const std::uint64_t until = now_us() + 200'000; now_us() < until;) {
    if (const auto f = usb.next()) others.push_back(*f);
  }
  EXPECT_TRUE(says(lines_of(others), "started: firmware "));
  EXPECT_TRUE(lines_of(frames).empty());
  expect_no_violation();
}

// While sixteen modules stream, the worst chatter of the log costs no sample and keeps the budgets.
TEST_F(Logs, CostsNoSample) {
  start(16, {wire::Decimation::k64, 1});
  ask_for_log(wire::LogLevel::kDebug);
  run_for(200'000);
  EXPECT_LE(budget(offsetof(board::Budget, worst_loop_us)), 400U) << "before faults are written into the flash";
  for (int k = 0; k < 20; ++k) {
    run_for(50'000);
    module_at(15).present = k % 2 == 1;
  }
  for (const auto& [m, list] : samples()) {
    if (m == 15) continue;
    for (std::size_t k = 1; k < list.size(); ++k) ASSERT_EQ(list[k].sample, list[k - 1].sample + 1) << "module " << m;
  }
  EXPECT_TRUE(says(lines_of(frames), "module in row 15: absent"));
  expect_no_violation();
}

TEST_F(Logs, CrashIsALineWithItsPlace) {
  store_table(patch(4));
  power_up();
  run_for(300'000);
  const std::uint32_t step = application.symbols.at("_ZN7triskin2fw11LineSampler4stepEy") & ~1U;
  machine->write_word(step, 0xDE01DE00);
  run_for(300'000);
  EXPECT_TRUE(says(terminal_lines(machine->serial_text()), "was stopped by a fault after ")) << machine->serial_text();
  std::ostringstream at;
  at << " at @" << std::hex << std::setw(8) << std::setfill('0') << step;
  EXPECT_TRUE(says(terminal_lines(machine->serial_text()), at.str())) << machine->serial_text();
}

// This list has all functions that run in interrupts and during an erase; the build makes it from the call graph.
TEST_F(Logs, NothingOfItRunsInInterruptsOrDuringAnErase) {
  std::ifstream list(firmware(running_slot == 0 ? "triskin_app_a.elf.ram" : "triskin_app_b.elf.ram"));
  std::ostringstream text;
  text << list.rdbuf();
  ASSERT_NE(text.str().find("LineSampler"), std::string::npos) << "the list names functions";
  for (const char* part :
       {"LogText", "LogSender", "SerialLog", "Journal", "fw::Log", "2fw3Log", "7Journal", "9LogSender"})
    EXPECT_EQ(text.str().find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace triskin::machine
