// SPDX-License-Identifier: GPL-3.0-or-later
// On the bus of an iCub, an independent reader and an independent board model must agree with the frames of the
// controller.
#include "icub_host.hpp"

#include <gtest/gtest.h>

#include "bench.hpp"
#include "triskin/app/identifiers.hpp"
#include "triskin/wire/node_claim.hpp"

namespace triskin::test {
namespace {

using icub_host::Mtb4;
using icub_host::Reader;
using icub_host::Triangle;

struct IcubHost : testing::Test {
  Bench bench;
  Reader reader;

  void SetUp() override {
    place_six(bench);
    for (LineDouble& line : bench.lines) {
      for (ChipDouble& chip : line.chips) chip.noise = 0;
    }
  }
  void power_up(const layout::PatchImage& image = six_modules()) {
    bench.power_up();
    ASSERT_EQ(bench.flash_table(image), Status::kOk);
    bench.run(1'000'000);
  }
  ChipDouble& chip(std::size_t module) { return bench.lines[module / 2].chips[module % 2]; }
  /// Returns the triangle of module k of six_modules().
  static int triangle(std::size_t module) { return static_cast<int>(4 * (module / 2) + module % 2); }

  void say(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
    wire::CanFrame f;
    f.id = id;
    for (const std::uint8_t b : bytes) f.data.at(f.size++) = b;
    bench.controller->receive(f);
  }
  /// Sends it and returns the frames within a millisecond that are no taxel frames.
  std::vector<wire::CanFrame> ask(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
    bench.stream.clear();
    say(id, bytes);
    bench.run(1'000);
    std::erase_if(bench.stream, [](const wire::CanFrame& f) { return (f.id & 0x700U) == 0x400; });
    return bench.stream;
  }
  static std::vector<int> bytes_of(const wire::CanFrame& f) { return {f.data.begin(), f.data.begin() + f.size}; }

  void start(std::uint8_t skin_type, std::uint8_t no_load, std::uint8_t shift) {
    say(0x201, {0x4D, skin_type, 50, no_load});
    say(0x201, {0x50, 0, 15, shift, 1, 0x00, 0x22});
    bench.run(100'000);
    say(0x201, {0x07, 0});
    bench.run(100'000);
  }
  /// Returns the state of the reader after `us`.
  std::map<std::pair<int, int>, Triangle>& listen(std::uint64_t us = 200'000) {
    bench.stream.clear();
    reader = {};
    bench.run(us);
    for (const wire::CanFrame& f : bench.stream) reader.take(f);
    EXPECT_EQ(reader.unknown, 0);
    return reader.triangles;
  }
  std::vector<int> flags() {
    const Message m = bench.ask({0x22, 0xFD, 0x30});
    return {m.begin(), m.end()};
  }
};

void expect_at_rest(const Triangle& t, int no_load, const char* error) {
  for (const int v : t.value) EXPECT_EQ(v, no_load);
  EXPECT_EQ(t.error(), error);
  EXPECT_EQ(t.out_of_range(), 0);
}

TEST_F(IcubHost, a_chip_that_is_absent_or_has_another_id_from_the_start_is_at_rest_and_not_connected) {
  chip(2).powered = false;
  chip(5).device_id = 0x1490;
  power_up();
  start(2, 245, 2);
  auto& got = listen();
  ASSERT_EQ(got.size(), 16U);  // An MTB4 board sends every enabled triangle, wired or not.
  for (int t = 0; t < 16; ++t) {
    SCOPED_TRACE(t);
    const bool there = t == 0 || t == 1 || t == 5 || t == 8;
    expect_at_rest(got.at({1, t}), 245, there ? "" : "not connected");
  }
  EXPECT_EQ(got.at({1, triangle(2)}).error_code, 0x0002);
}

TEST_F(IcubHost, a_chip_that_dies_is_at_rest_and_not_connected_never_full_pressure) {
  power_up();
  start(2, 240, 3);
  chip(3).powered = false;
  bench.run(500'000);
  expect_at_rest(listen().at({1, triangle(3)}), 240, "not connected");
  chip(3).powered = true;
  bench.run(3'000'000);
  expect_at_rest(listen().at({1, triangle(3)}), 240, "");
}

TEST_F(IcubHost, a_line_that_is_held_low_is_at_rest_and_without_acknowledge) {
  power_up();
  start(2, 245, 2);
  bench.lines[1].sda_low = true;
  bench.run(500'000);
  auto& got = listen();
  for (const std::size_t module : {2U, 3U}) expect_at_rest(got.at({1, triangle(module)}), 245, "no ack");
  expect_at_rest(got.at({1, triangle(0)}), 245, "");
}

TEST_F(IcubHost, triangles_are_numbered_by_line_and_address) {
  layout::PatchImage image = six_modules();
  image.module_count = 3;
  for (LineDouble& line : bench.lines) line.chips.clear();
  const std::array<std::pair<std::uint8_t, std::uint8_t>, 3> places{{{3, 2}, {0, 3}, {1, 0}}};
  for (std::size_t k = 0; k < places.size(); ++k) {
    image.modules[k].line = places[k].first;
    image.modules[k].address = places[k].second;
    ChipDouble c;
    c.address = layout::cdc_address(places[k].second);
    c.noise = 0;
    bench.lines[places[k].first].chips.push_back(c);
  }
  power_up(image);
  start(2, 245, 2);
  bench.lines[3].chips[0].counts[4] += 400;
  bench.run(100'000);
  auto& got = listen();
  for (int t = 0; t < 16; ++t)
    EXPECT_EQ(got.at({1, t}).error(), t == 14 || t == 3 || t == 4 ? "" : "not connected") << t;
  EXPECT_EQ(got.at({1, 14}).value[4], 145);
}

TEST_F(IcubHost, values_without_compensation_are_those_of_the_board_model) {
  power_up();
  for (const auto& [no_load, shift] : {std::pair{245, 2}, {240, 6}, {200, 0}, {128, 4}, {245, 7}}) {
    SCOPED_TRACE(std::to_string(no_load) + " " + std::to_string(shift));
    const Mtb4 board{no_load, shift};
    for (std::size_t m = 0; m < 6; ++m) chip(m).counts.fill(-8000);
    bench.run(200'000);
    start(2, static_cast<std::uint8_t>(no_load), static_cast<std::uint8_t>(shift));
    int rise = -1500;
    for (std::size_t m = 0; m < 6; ++m) {
      for (std::size_t t = 0; t < 12; ++t, rise += 61) chip(m).counts[t] = -8000 + rise;
    }
    bench.run(200'000);
    auto& got = listen();
    for (std::size_t m = 0; m < 6; ++m) {
      const Triangle& triangle_m = got.at({1, triangle(m)});
      for (std::size_t t = 0; t < 12; ++t) {
        const int r = chip(m).counts[t] + 8000;
        EXPECT_EQ(triangle_m.value[t], board.value(r)) << r;
        EXPECT_EQ(triangle_m.out_of_range() >> t & 1, board.out_of_range(r) ? 1 : 0) << r;
      }
      EXPECT_EQ(triangle_m.error(), "");
    }
  }
}

TEST_F(IcubHost, a_taxel_at_the_end_of_the_converter_is_at_its_limit_and_out_of_range) {
  power_up();
  start(2, 245, 2);
  chip(0).counts[3] = 60'000;
  chip(0).counts[8] = -60'000;
  bench.run(300'000);
  const Triangle& t = listen().at({1, 0});
  EXPECT_EQ(t.value[3], 0);
  EXPECT_EQ(t.value[8], 255);
  EXPECT_EQ(t.value[0], 245);
  EXPECT_EQ(t.out_of_range(), 1 << 3 | 1 << 8);
}

TEST_F(IcubHost, the_skin_type_chooses_the_compensation) {
  power_up();
  const auto warm = [&](int counts) {
    for (int& c : chip(0).counts) c += counts;
    bench.run(200'000);
  };
  start(0, 200, 2);
  warm(80);
  for (const int v : listen().at({1, 0}).value)
    EXPECT_NEAR(v, 200, 20);  // The pads explain this change, and show it themselves.
  EXPECT_NEAR(reader.triangles.at({1, 0}).value[0], 200, 1);
  start(2, 200, 2);
  warm(80);
  for (const int v : listen().at({1, 0}).value) EXPECT_EQ(v, 180);
  start(1, 200, 2);  // The gains of a palm are all zero.
  warm(80);
  for (const int v : listen().at({1, 0}).value) EXPECT_EQ(v, 180);
  start(7, 200, 2);  // The values are low bytes of results whose middle the converter's offsets have moved.
  const Triangle before = listen().at({1, 0});
  warm(5);
  const Triangle& raw = listen().at({1, 0});
  for (std::size_t t = 0; t < 12; ++t) EXPECT_EQ(raw.value[t], (before.value[t] + 5) & 0xFF);
}

TEST_F(IcubHost, new_offsets_of_the_converter_are_no_pressure) {
  power_up();
  start(2, 245, 2);
  for (int& c : chip(0).counts) c += 20'000;
  bench.run(200'000);
  EXPECT_EQ(listen().at({1, 0}).value[0], 0);
  EXPECT_EQ(bench.ask({0x31, 0x01, 0x02, 0x06}).at(0), 0x71);
  bench.run(3'000'000);
  expect_at_rest(listen().at({1, 0}), 245, "");
}

TEST_F(IcubHost, a_board_configuration_switches_all_triangles_off_until_they_are_configured) {
  power_up();
  say(0x201, {0x07, 0});
  EXPECT_EQ(listen().size(), 16U);
  say(0x201, {0x4D, 2, 50, 245});
  bench.run(1'000);
  EXPECT_TRUE(listen().empty());
  say(0x201, {0x50, 1, 2, 2, 1, 0x00, 0x22});
  say(0x201, {0x07, 0});
  bench.run(1'000);
  EXPECT_EQ(listen().size(), 2U);
}

TEST_F(IcubHost, a_triangle_configuration_stops_the_stream_and_calibrates) {
  power_up();
  start(2, 245, 2);
  chip(0).counts[0] += 200;
  bench.run(100'000);
  EXPECT_EQ(listen().at({1, 0}).value[0], 195);
  say(0x201, {0x50, 0, 15, 3, 1, 0x00, 0x22});
  bench.run(100'000);
  EXPECT_TRUE(listen().empty());
  say(0x201, {0x07, 0});
  EXPECT_EQ(listen().at({1, 0}).value[0], 245);
}

TEST_F(IcubHost, a_fresh_board_has_the_defaults_of_the_other) {
  power_up();
  say(0x201, {0x07, 0});
  chip(1).counts[0] += 200;
  bench.run(100'000);
  EXPECT_EQ(listen().at({1, 1}).value[0], 195);                   // The taxel reads 245 at rest, with shift 2.
  EXPECT_NEAR(listen(10'000'000).at({1, 1}).halves, 2 * 200, 4);  // The period is 50 ms.
}

TEST_F(IcubHost, the_older_set_up_restores_defaults_calibrates_and_starts_at_40_ms) {
  power_up();
  say(0x201, {0x4D, 2, 200, 99});
  say(0x201, {0x50, 0, 3, 4, 0, 0x00, 0x22});
  chip(1).counts[0] += 2000;
  bench.run(100'000);
  say(0x201, {0x4C, 1, 1, 3, 0, 0x20, 0, 0x35});
  bench.run(100'000);
  auto& got = listen(10'000'000);
  ASSERT_EQ(got.size(), 16U);
  expect_at_rest(got.at({1, 1}), 245, "");
  EXPECT_NEAR(got.at({1, 1}).halves, 2 * 250, 4);
}

TEST_F(IcubHost, a_host_that_speaks_to_everybody_is_obeyed) {
  power_up();
  say(0x20F, {0x07, 0});
  EXPECT_EQ(listen().size(), 16U);
  say(0x20F, {0x07, 1});
  bench.run(50'000);
  EXPECT_TRUE(listen().empty());
}

TEST_F(IcubHost, the_firmware_version_is_told_with_the_protocol_and_whether_it_fits) {
  power_up();
  constexpr int kMajor = fw::kFirmwareVersion >> 24, kMinor = fw::kFirmwareVersion >> 16 & 0xFF;
  const std::vector<int> fits{0x1C, 0x0B, kMajor, kMinor, 0, 2, 0, 1}, differs{0x1C, 0x0B, kMajor, kMinor, 0, 2, 0, 0};
  for (const std::uint32_t id : {0x201U, 0x20FU}) {
    const auto answers = ask(id, {0x1C, 2, 0});
    ASSERT_EQ(answers.size(), 1U);
    EXPECT_EQ(answers[0].id, 0x210U);
    EXPECT_EQ(bytes_of(answers[0]), fits);
  }
  EXPECT_EQ(bytes_of(ask(0x201, {0x1C, 2, 1}).at(0)), differs);
  EXPECT_EQ(bytes_of(ask(0x201, {0x1C, 1, 0}).at(0)), differs);
  EXPECT_TRUE(ask(0x202, {0x1C, 2, 0}).empty());
}

TEST_F(IcubHost, the_description_comes_in_eight_frames) {
  power_up();
  const auto answers = ask(0x701, {0x0C});
  ASSERT_EQ(answers.size(), 8U);
  std::string text;
  for (std::size_t k = 0; k < 8; ++k) {
    EXPECT_EQ(answers[k].id, 0x710U);
    ASSERT_EQ(answers[k].size, 6);
    EXPECT_EQ(answers[k].data[0], 0x0C);
    EXPECT_EQ(answers[k].data[1], k);
    for (std::size_t b = 2; b < 6; ++b) text += static_cast<char>(answers[k].data[b]);
  }
  EXPECT_EQ(text, "Triskin 0102030405060708090A0B0C");
}

TEST_F(IcubHost, the_time_of_life_is_told_in_microseconds) {
  power_up();
  const auto answers = ask(0x701, {0x0E});
  ASSERT_EQ(answers.size(), 1U);
  ASSERT_EQ(answers[0].size, 8);
  EXPECT_EQ(answers[0].data[0], 0x0E);
  std::uint64_t us = 0;
  for (std::size_t b = 7; b >= 1; --b) us = us << 8 | answers[0].data[b];
  EXPECT_NEAR(static_cast<double>(us), static_cast<double>(bench.now_us), 2'000);
}

TEST_F(IcubHost, an_address_is_set_as_on_the_other_board) {
  power_up();
  EXPECT_TRUE(ask(0x201, {0x32, 5}).empty());
  ASSERT_EQ(ask(0x705, {0xFF}).size(), 1U);
  EXPECT_TRUE(ask(0x701, {0xFF}).empty());
  EXPECT_TRUE(ask(0x705, {0x32, 9}).empty());
  ASSERT_EQ(ask(0x709, {0xFF}).size(), 1U);
  EXPECT_TRUE(ask(0x709, {0x32, 0xFF, 0xFE, 0x0F}).empty());  // Every value but 1 … 11 is refused.
  const auto found = ask(0x70F, {0xFF});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_GE(found[0].id >> 4 & 0xF, 12U);
  EXPECT_LE(found[0].id >> 4 & 0xF, 14U);
}

TEST_F(IcubHost, an_address_for_everybody_or_out_of_range_is_refused_and_reported) {
  power_up();
  for (const auto& [id, address] :
       {std::pair<std::uint32_t, std::uint8_t>{0x20F, 5}, {0x70F, 5}, {0x201, 0}, {0x201, 15}}) {
    EXPECT_TRUE(ask(id, {0x32, address}).empty());
    EXPECT_EQ(ask(0x701, {0xFF}).size(), 1U);
  }
  EXPECT_EQ(flags().at(3) & 4, 4);
  EXPECT_EQ(flags().at(4), 0x32);
  EXPECT_EQ(flags().at(5), 4);
}

TEST_F(IcubHost, a_restart_is_obeyed_and_forgets_the_settings) {
  power_up();
  start(2, 99, 0);
  say(0x701, {0x00, 0});
  bench.run(1'000'000);
  EXPECT_TRUE(listen().empty());
  say(0x201, {0x07, 0});
  expect_at_rest(listen().at({1, 0}), 245, "");
}

TEST_F(IcubHost, an_offset_of_the_converter_is_refused_and_reported_but_calibrates) {
  power_up();
  EXPECT_EQ(flags().at(3) & 2, 0);
  say(0x201, {0x50, 0, 15, 2, 1, 0x00, 0x22});
  bench.run(50'000);
  EXPECT_EQ(flags().at(3) & 2, 0);
  say(0x201, {0x50, 0, 15, 2, 1, 0x34, 0x12});
  bench.run(50'000);
  EXPECT_EQ(flags().at(3) & 2, 2);
  EXPECT_EQ(flags().at(4), 0x50);
}

TEST_F(IcubHost, sensors_that_are_not_there_are_refused_and_reported) {
  power_up();
  for (const std::uint8_t command :
       std::to_array<std::uint8_t>({0x4F, 0x24, 0x26, 0x27, 0x29, 0x33, 0x35, 0x39, 0x3A})) {
    EXPECT_TRUE(ask(0x201, {command, 1, 1}).empty());
    EXPECT_EQ(flags().at(3) & 8, 8);
    EXPECT_EQ(flags().at(4), command);
  }
}

TEST_F(IcubHost, a_node_that_is_no_board_neither_answers_nor_streams) {
  bench.power_up();
  bench.unlock();
  ASSERT_EQ(bench.ask({0x2E, 0xFD, 0x01, 17}).at(0), 0x6E);
  bench.node = 17;
  bench.run(100'000);
  layout::PatchImage image = six_modules(17);
  ASSERT_EQ(bench.flash_table(image), Status::kOk);
  bench.run(1'000'000);
  for (const std::uint32_t id : {0x201U, 0x20FU, 0x701U, 0x70FU}) {
    EXPECT_TRUE(ask(id, {0x1C, 2, 0}).empty());
    EXPECT_TRUE(ask(id, {0xFF}).empty());
    say(id, {0x07, 0});
  }
  EXPECT_TRUE(listen().empty());
  bench.unlock();
  EXPECT_EQ(bench.ask({0x2E, 0xFD, 0x05, 0x01}), (Message{0x7F, 0x2E, 0x31}));
  EXPECT_TRUE(listen().empty());
  EXPECT_EQ(flags().at(3) & 1, 1);
}

TEST_F(IcubHost, a_board_that_gets_a_high_address_while_it_streams_stops) {
  power_up();
  start(2, 245, 2);
  EXPECT_EQ(listen().size(), 16U);
  for (const wire::CanFrame& f : wire::encode_assignment({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, 17))
    bench.controller->receive(f);
  bench.run(100'000);
  EXPECT_TRUE(listen(500'000).empty());
}

// The host sends discovery of the boards, silence, boards, triangles, half a second of rest, start; after that a press
// and the end.
TEST_F(IcubHost, the_start_of_an_ethernet_host_is_answered_as_by_the_other_board) {
  chip(4).powered = false;
  power_up();
  const auto version = ask(0x201, {0x1C, 2, 0});
  ASSERT_EQ(version.size(), 1U);
  EXPECT_EQ(version[0].id >> 4 & 0xF, 1U);  // The host takes the address from the source field.
  EXPECT_EQ(version[0].data[1], 0x0B);      // The type must be that of the configuration.
  EXPECT_EQ(version[0].data[7], 1);         // The protocol fits.
  EXPECT_TRUE(ask(0x201, {0x07, 1}).empty());
  EXPECT_TRUE(ask(0x201, {0x4D, 0, 50, 245}).empty());
  EXPECT_TRUE(ask(0x201, {0x50, 0, 15, 2, 1, 0x00, 0x22}).empty());
  // This special configuration fails because line 3 has no triangles.
  EXPECT_TRUE(ask(0x201, {0x50, 12, 15, 2, 0, 0x00, 0x22}).empty());
  EXPECT_TRUE(listen(500'000).empty());
  EXPECT_TRUE(ask(0x201, {0x07, 0}).empty());
  auto& got = listen(1'000'000);
  ASSERT_EQ(got.size(), 12U);
  for (const auto& [place, t] : got) {
    EXPECT_NEAR(t.halves, 2 * 20, 2);
    const bool there = place.second % 4 < 2 && place.second != triangle(4);
    expect_at_rest(t, 245, there ? "" : "not connected");
  }
  chip(5).counts[2] += 400;
  bench.run(100'000);
  EXPECT_NEAR(listen().at({1, triangle(5)}).value[2], 145, 1);
  EXPECT_TRUE(ask(0x201, {0x07, 1}).empty());
  bench.run(50'000);
  EXPECT_TRUE(listen().empty());
}

}  // namespace
}  // namespace triskin::test
