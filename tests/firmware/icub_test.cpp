// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <set>

#include "bench.hpp"
#include "vectors/vector_file.hpp"

namespace triskin::test {
namespace {

wire::CanFrame frame_of(const std::string& text) {
  std::istringstream in(text);
  std::string id, rest;
  in >> id;
  std::getline(in, rest);
  wire::CanFrame f;
  f.id = static_cast<std::uint32_t>(std::stoul(id, nullptr, 16));
  for (const std::uint8_t b : hex_bytes(rest)) f.data.at(f.size++) = b;
  return f;
}

struct Icub : testing::Test {
  Bench bench;
  void SetUp() override {
    place_six(bench);
    for (LineDouble& line : bench.lines) {
      for (ChipDouble& chip : line.chips) chip.noise = 0;
    }
    bench.power_up();
    ASSERT_EQ(bench.flash_table(six_modules()), Status::kOk);
    bench.run(1'000'000);
  }
  void send_status(const std::string& text) {
    bench.controller->receive(frame_of(text));
    bench.stream.clear();
    bench.run(1'000);
  }
  std::set<unsigned> modules_of(std::uint64_t us) {
    bench.stream.clear();
    bench.run(us);
    std::set<unsigned> modules;
    for (std::size_t k = 0; k + 1 < bench.stream.size(); k += 2) {
      const auto t = wire::decode_icub(bench.stream[k], bench.stream[k + 1]);
      EXPECT_TRUE(t);
      if (t && !t->not_connected) modules.insert(t->module);
    }
    return modules;
  }
};

TEST_F(Icub, CommandsAreAnsweredAsTheFileSays) {
  for (const Vector& v : read_vectors("icub_commands.txt")) {
    SCOPED_TRACE(v.name);
    send_status("201 07 01");  // No stream arrives between the answers.
    send_status(v.one("host"));
    if (v.one("board").empty()) {
      std::erase_if(bench.stream, [](const wire::CanFrame& f) { return (f.id & 0x700) == 0x400; });
      EXPECT_TRUE(bench.stream.empty());
    } else {
      ASSERT_EQ(bench.stream.size(), 1U);
      EXPECT_EQ(bench.stream[0], frame_of(v.one("board")));
    }
  }
}

TEST_F(Icub, StartsStopsAndLeavesOutTriangles) {
  EXPECT_TRUE(modules_of(200'000).empty());
  send_status("201 07 00");
  EXPECT_EQ(modules_of(200'000), (std::set<unsigned>{0, 1, 4, 5, 8, 9}));
  send_status("201 50 04 08 06 00 00 22");
  EXPECT_TRUE(modules_of(200'000).empty());  // A configuration stops the stream.
  send_status("201 07 00");
  EXPECT_EQ(modules_of(200'000), (std::set<unsigned>{0, 1, 9}));
  send_status("201 07 01");
  EXPECT_TRUE(modules_of(200'000).empty());
  send_status("201 4C 01 01 00 00 22 00 00");
  EXPECT_EQ(modules_of(200'000), (std::set<unsigned>{0, 1, 4, 5, 8, 9}));
}

// Triangles 4 … 8 are switched off: bits 4 … 8 of FFFF are clear, little-endian at the end of FD30.
TEST_F(Icub, TheStateNamesTheEnabledTriangles) {
  Message state = bench.ask({0x22, 0xFD, 0x30});
  ASSERT_EQ(state.size(), 3U + 9);
  EXPECT_EQ((Message{state.end() - 2, state.end()}), (Message{0xFF, 0xFF}));
  send_status("201 50 04 08 06 00 00 22");
  state = bench.ask({0x22, 0xFD, 0x30});
  ASSERT_EQ(state.size(), 3U + 9);
  EXPECT_EQ((Message{state.end() - 2, state.end()}), (Message{0x0F, 0xFE}));
}

TEST_F(Icub, RestValueShiftAndPeriodAreObeyed) {
  send_status("201 4D 01 32 F5");
  send_status("201 50 00 0F 05 01 00 22");
  bench.run(100'000);  // This reading is at rest.
  send_status("201 07 00");
  bench.lines[0].chips[0].counts[0] += 320;
  bench.run(100'000);
  bench.stream.clear();
  bench.run(5'000'000);
  EXPECT_NEAR(static_cast<double>(bench.stream.size()) / 32, 100.0, 2.0);  // The period is 50 ms.
  const auto t = wire::decode_icub(bench.stream.at(0), bench.stream.at(1));
  ASSERT_TRUE(t);
  EXPECT_EQ(t->value[0], 235);  // The value is 245 less 320 >> 5.
  EXPECT_EQ(t->value[1], 245);
}

TEST_F(Icub, MalformedCommandsChangeNothing) {
  for (const char* text : {"201 07", "201 4D 01", "201 50 05 04 06 00 00 22", "201 50 00 10 06 00 00 22", "202 07 00",
                           "301 07 00", "201 19"}) {
    send_status(text);
    EXPECT_TRUE(bench.stream.empty()) << text;
  }
  send_status("201 07 00");
  EXPECT_EQ(modules_of(200'000).size(), 6U);
  send_status("201 07 01");
}

}  // namespace
}  // namespace triskin::test
