// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the controller with the table of identifiers: each must answer with a value of its length that its type
// decodes.
#include <gtest/gtest.h>

#include "bench.hpp"
#include "calibration_value.hpp"
#include "triskin/wire/lines.hpp"
#include "triskin/wire/live_taxels.hpp"
#include "triskin/wire/statistics.hpp"
#include "triskin/wire/topology.hpp"

namespace triskin::test {
namespace {

Message read(Bench& bench, std::uint16_t did) {
  return bench.ask({0x22, static_cast<std::uint8_t>(did >> 8), static_cast<std::uint8_t>(did)});
}

template <class Value>
Value value_of(Bench& bench) {
  return Value::decode(Bytes(read(bench, Value::kId)).subspan(3)).value();
}

void start(Bench& bench) {
  for (LineDouble& line : bench.lines) line.chips.clear();
  bench.power_up();
  ASSERT_EQ(bench.flash_table(six_modules()), Status::kOk);
  Message calibration{0x2E, 0xFD, 0x0D};
  const auto value = bytes_of(calibration_of(six_modules(), 3));
  calibration.insert(calibration.end(), value.begin(), value.end());
  ASSERT_EQ(bench.ask(calibration), (Message{0x6E, 0xFD, 0x0D}));
  bench.run(500'000);
}

TEST(Identifiers, each_answers_with_a_value_of_its_length) {
  Bench bench;
  start(bench);
  int answered = 0;
  for (const wire::Identifier& i : wire::kIdentifiers) {
    SCOPED_TRACE(i.id);
    const Message m = read(bench, i.id);
    // The test has no loader.
    const bool silent = i.access == wire::Access::kFreeze || i.id == wire::did::kImageState;
    if (silent) {
      EXPECT_EQ(m, (Message{0x7F, 0x22, wire::nrc::kOutOfRange}));
      continue;
    }
    ASSERT_GE(m.size(), 3U);
    EXPECT_EQ(m[0], 0x62);
    EXPECT_GE(m.size() - 3, i.min_bytes);
    EXPECT_LE(m.size() - 3, i.max_bytes);
    ++answered;
  }
  EXPECT_EQ(answered, 25);
}

TEST(Identifiers, only_those_that_may_be_written_are) {
  Bench bench;
  start(bench);
  for (const wire::Identifier& i : wire::kIdentifiers) {
    SCOPED_TRACE(i.id);
    // Writing a node address restarts the controller.
    bench.unlock();
    Message value = read(bench, i.id);
    if (value.at(0) != 0x62) continue;
    // The test writes back the value that it read.
    value[0] = 0x2E;
    const bool taken = bench.ask(value).at(0) == 0x6E;
    EXPECT_EQ(taken, i.access == wire::Access::kReadWrite);
    bench.unlock();
    value.resize(3 + i.max_bytes + 1);
    EXPECT_EQ(bench.ask(value), (Message{0x7F, 0x2E, wire::nrc::kOutOfRange})) << "a byte too many";
  }
}

TEST(Identifiers, values_say_what_the_patch_is) {
  Bench bench;
  start(bench);
  EXPECT_EQ(value_of<wire::Hello>(bench).unique_id, (wire::UniqueId{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}));
  const auto table = value_of<wire::ActiveTable>(bench);
  EXPECT_TRUE(table.present());
  EXPECT_EQ(table.design_id, 6U);
  EXPECT_EQ(table.modules, 6);
  const auto states = value_of<wire::ModuleStates>(bench);
  EXPECT_EQ(states.count, 6);
  for (const wire::ModuleState s : states.rows()) EXPECT_EQ(s, wire::ModuleState::kAbsent);
  EXPECT_GT(value_of<wire::Statistics>(bench).bus_errors, 0U);
  EXPECT_GT(value_of<wire::Statistics>(bench).sequences, 0U);
  EXPECT_EQ(value_of<wire::LineStates>(bench), wire::LineStates{});
  EXPECT_EQ(value_of<wire::LiveTaxels>(bench).count, 6);
  EXPECT_EQ(value_of<wire::ActiveRoute>(bench).rows, 6);
  EXPECT_FALSE(value_of<wire::FoundTopology>(bench).switched);
  EXPECT_EQ(value_of<wire::SamplingSetting>(bench), wire::SamplingSetting{});
}

TEST(Identifiers, sampling_is_read_back_as_written) {
  Bench bench;
  start(bench);
  bench.unlock();
  EXPECT_EQ(bench.ask({0x2E, 0xFD, 0x0A, 0x01, 0x05, 0x01}), (Message{0x6E, 0xFD, 0x0A}));
  EXPECT_EQ(value_of<wire::SamplingSetting>(bench),
            (wire::SamplingSetting{wire::Decimation::k128, 5, wire::TaxelOutput::kCompensated}));
  EXPECT_EQ(bench.ask({0x2E, 0xFD, 0x0A, 0x03, 0x05, 0x01}), (Message{0x7F, 0x2E, 0x31}));
}

}  // namespace
}  // namespace triskin::test
