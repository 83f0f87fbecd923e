// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/diagnostics/log.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "triskin/logic/diagnostics/log_sender.hpp"

namespace triskin::fw {
namespace {

using wire::LogLevel;

void say(Log& log, const std::string& text, std::uint64_t now_us = 0) {
  log.add<LogLevel::kInformation>(now_us, [&](LogText& t) { t.text(text); });
}

std::vector<std::string> read_all(const Log& log, Log::Reader& reader) {
  std::vector<std::string> lines;
  for (const wire::LogLine* line = log.next(reader); line != nullptr; line = log.next(reader)) {
    lines.emplace_back(line->view());
    ++reader.at;
  }
  return lines;
}

TEST(Log, TextIsWordsNumbersAndAddresses) {
  Log log;
  log.add<LogLevel::kError>(1'234'567, [](LogText& t) {
    t.text("stopped ").decimal(0).text(", ").decimal(4'294'967'295).text(" at ").address(0x0800AB0F);
  });
  Log::Reader reader{LogLevel::kError, 0};
  const wire::LogLine* line = log.next(reader);
  ASSERT_NE(line, nullptr);
  EXPECT_EQ(line->view(), "stopped 0, 4294967295 at @0800ab0f");
  EXPECT_EQ(line->time_ms, 1234U);
  EXPECT_EQ(line->level, LogLevel::kError);
}

TEST(Log, ALongLineIsCutAtItsEnd) {
  Log log;
  say(log, std::string(200, 'x'));
  Log::Reader reader{LogLevel::kDebug, 0};
  EXPECT_EQ(read_all(log, reader), std::vector{std::string(wire::kMaxLogText, 'x')});
}

TEST(Log, AReaderGetsItsLevelsOnce) {
  Log log;
  log.add<LogLevel::kWarning>(0, [](LogText& t) { t.text("w"); });
  say(log, "i");
  log.add<LogLevel::kError>(0, [](LogText& t) { t.text("e"); });
  Log::Reader warnings{LogLevel::kWarning, 0}, all{LogLevel::kDebug, 0}, nothing{LogLevel::kOff, 0};
  EXPECT_EQ(read_all(log, warnings), (std::vector<std::string>{"w", "e"}));
  EXPECT_EQ(read_all(log, all), (std::vector<std::string>{"w", "i", "e"}));
  EXPECT_EQ(read_all(log, nothing), std::vector<std::string>{});
  EXPECT_EQ(read_all(log, all), std::vector<std::string>{}) << "it has had them";
}

// The image is built with level 3: a line of level 4 is not in it, and its text is not even formatted.
TEST(Log, LevelsThatAreNotCompiledInCostNothing) {
  static_assert(kCompiledLogLevel == LogLevel::kInformation, "the levels of this build");
  Log log;
  bool made = false;
  log.add<LogLevel::kDebug>(0, [&](LogText&) { made = true; });
  EXPECT_FALSE(made);
  Log::Reader reader{LogLevel::kDebug, 0};
  EXPECT_EQ(log.next(reader), nullptr);
}

TEST(Log, TheOldestLinesAreOverwrittenAndTheirNumbersShowIt) {
  Log log;
  for (int k = 0; k < 20; ++k) say(log, std::to_string(k));
  Log::Reader reader{LogLevel::kDebug, 0};
  const wire::LogLine* first = log.next(reader);
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(first->view(), "4");
  EXPECT_EQ(first->number, 4);
  EXPECT_EQ(read_all(log, reader).size(), 16U);
}

class Port final : public CanPort {
 public:
  [[nodiscard]] bool fd() const override { return true; }
  bool send(const wire::CanFrame& frame) override {
    if (room == 0) return false;
    --room;
    frames.push_back(frame);
    return true;
  }
  std::optional<wire::CanFrame> receive() override { return std::nullopt; }
  int room = 1'000;
  std::vector<wire::CanFrame> frames;
};

std::vector<std::string> lines_of(const Port& port) {
  wire::LogDecoder decoder;
  std::vector<std::string> lines;
  for (const wire::CanFrame& f : port.frames) {
    if (const auto line = decoder.add(f)) lines.emplace_back(line->view());
  }
  return lines;
}

TEST(LogSender, SendsOneFrameAMillisecondAndWaitsForRoom) {
  Log log;
  Port port;
  LogSender sender;
  say(log, "a line of 25 letters, see");
  EXPECT_EQ(sender.next_us(log), UINT64_MAX) << "nobody has asked";
  sender.set(LogLevel::kInformation, 8);
  std::uint64_t now = 5'000;
  for (int k = 0; k < 10; ++k) sender.step(log, port, 7, now);
  EXPECT_EQ(port.frames.size(), 1U);
  EXPECT_EQ(sender.next_us(log), now + 1'000);
  port.room = 0;
  sender.step(log, port, 7, now += 1'000);
  EXPECT_EQ(port.frames.size(), 1U);
  port.room = 100;
  while (sender.next_us(log) != UINT64_MAX) sender.step(log, port, 7, now = sender.next_us(log));
  EXPECT_EQ(port.frames.size(), 1U + 4) << "one letter, then 24 in sevens";
  EXPECT_EQ(lines_of(port), std::vector<std::string>{"a line of 25 letters, see"});
  EXPECT_EQ(port.frames[0].id, 0x18E4FF07U);
}

// When half of a line is sent, sixteen others overwrite it: it is given up, and the next line is complete.
TEST(LogSender, ALineThatIsOverwrittenMeanwhileIsGivenUp) {
  Log log;
  Port port;
  LogSender sender;
  sender.set(LogLevel::kInformation, 8);
  say(log, "this one is sent only in part");
  sender.step(log, port, 1, 0);
  for (int k = 0; k < 16; ++k) say(log, "line " + std::to_string(k));
  for (std::uint64_t now = 1'000; sender.next_us(log) != UINT64_MAX; now += 1'000) sender.step(log, port, 1, now);
  const auto lines = lines_of(port);
  ASSERT_EQ(lines.size(), 16U);
  EXPECT_EQ(lines.front(), "line 0");
  EXPECT_EQ(lines.back(), "line 15");
}

class Terminal final : public SerialPort {
 public:
  bool send(std::uint8_t byte) override {
    if (room == 0) return false;
    --room;
    text += static_cast<char>(byte);
    return true;
  }
  int room = 8;
  std::string text;
};

TEST(SerialLog, WritesLinesWithTimeAndLevelAsThePortTakesThem) {
  Log log;
  Terminal terminal;
  SerialLog serial(&terminal);
  say(log, "started", 7'000);
  log.add<LogLevel::kWarning>(83'456'789'000, [](LogText& t) { t.text("module 5 absent"); });
  int steps = 0;
  for (; serial.waits(log); ++steps) {
    serial.step(log);
    terminal.room = 8;
  }
  EXPECT_EQ(terminal.text,
            "      0.007 started\r\n"
            "  83456.789 warning: module 5 absent\r\n");
  EXPECT_EQ(steps, static_cast<int>((terminal.text.size() + 7) / 8));
}

// Together they are several times as long as the buffer of one line.
TEST(SerialLog, LongLinesFollowOneAnother) {
  Log log;
  Terminal terminal;
  terminal.room = 10'000;
  SerialLog serial(&terminal);
  std::string expected;
  for (int k = 0; k < 10; ++k) {
    const std::string line(wire::kMaxLogText, static_cast<char>('a' + k));
    say(log, line, 1'000);
    expected += "      0.001 " + line + "\r\n";
  }
  serial.step(log);
  EXPECT_EQ(terminal.text, expected);
  EXPECT_FALSE(serial.waits(log));
}

TEST(SerialLog, ABoardWithoutAPortWaitsForNothing) {
  Log log;
  SerialLog serial(nullptr);
  say(log, "nobody reads it");
  EXPECT_FALSE(serial.waits(log));
  serial.step(log);
}

}  // namespace
}  // namespace triskin::fw
