// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "bench.hpp"
#include "triskin/sim/flash_model.hpp"
#include "triskin/wire/calibration.hpp"

namespace triskin::machine {
namespace {

class Table : public Bench {
 protected:
  // Returns the number of modules of the active table; 0 without one.
  int modules() {
    const auto reply = request({0x22, 0xFD, 0x02});
    return reply.size() >= 21 ? reply[3 + 1 + 4 + 8 + 4] : 0;
  }
};

TEST_F(Table, ActivatedTableIsActiveAfterAPowerCycle) {
  power_up();
  run_for(100'000);
  ASSERT_TRUE(flash_table(patch(5)));
  EXPECT_EQ(modules(), 5);
  power_up();
  run_for(100'000);
  EXPECT_EQ(modules(), 5);
  expect_no_violation();
}

TEST_F(Table, PowerCutInEachFlashOperationLeavesTheOldOrTheNewTable) {
  store_table(patch(4));
  const FlashChip before = flash;
  power_up();
  run_for(500'000);  // All four are found by now, so no fault is written in between.
  flash.operations = 0;
  const std::uint64_t first = flash.operations;
  ASSERT_TRUE(flash_table(patch(8)));
  const std::uint64_t operations = flash.operations - first;
  EXPECT_EQ(operations, 1U + (32 + 8 * 12) / 8 + 2);  // The operations are erase, image and commit record.
  for (std::uint64_t cut = 0; cut < operations; ++cut) {
    flash = before;
    flash.operations = 0;
    power_up();
    run_for(500'000);
    flash.cut_power_after(cut);
    EXPECT_THROW((void)flash_table(patch(8)), sim::PowerLost) << cut;
    flash.cut_at = ~std::uint64_t{0};
    power_up();
    run_for(100'000);
    EXPECT_EQ(modules(), 4) << "cut in operation " << cut;  // The last record is torn, too: its CRC is wrong.
    ASSERT_TRUE(flash_table(patch(6))) << "cut in operation " << cut;  // The slot can be used again.
    EXPECT_EQ(modules(), 6) << cut;
    expect_no_violation();
  }
}

// Four modules make a value of 143 bytes: 20 units with head and CRC. Twelve records fill the page beside the table.
class CalibrationCase : public Table {
 protected:
  static std::vector<std::uint8_t> value_of(std::uint16_t revision) {
    const layout::PatchImage table = patch(4);
    wire::Calibration c{.exponent = 7, .revision = revision, .design_id = table.design_id};
    for (const layout::ModuleRow& m : table.rows()) {
      wire::PlaceSensitivity& p = c.places[c.count++];
      p.place = static_cast<std::uint8_t>(layout::kAddressesPerLine * m.line + m.address);
      p.sensitivity.fill(static_cast<std::uint16_t>(19'200 + revision));
    }
    std::vector<std::uint8_t> bytes(wire::Calibration::kMaxBytes);
    ByteWriter w(bytes);
    c.encode(w);
    bytes.resize(w.size());
    return bytes;
  }
  bool write(std::uint16_t revision) {
    unlock();
    std::vector<std::uint8_t> request_bytes{0x2E, 0xFD, 0x0D};
    const auto value = value_of(revision);
    request_bytes.insert(request_bytes.end(), value.begin(), value.end());
    return request(request_bytes) == std::vector<std::uint8_t>{0x6E, 0xFD, 0x0D};
  }
  /// Returns the calibration that the controller reports; empty if it has none.
  std::vector<std::uint8_t> kept() {
    const auto reply = request({0x22, 0xFD, 0x0D});
    return reply.empty() || reply[0] != 0x62 ? std::vector<std::uint8_t>{}
                                             : std::vector<std::uint8_t>(reply.begin() + 3, reply.end());
  }
};

class CalibrationOfATable : public CalibrationCase, public ::testing::WithParamInterface<bool> {};
class CalibrationCut : public CalibrationCase {};

TEST_P(CalibrationOfATable, OutlivesPowerAndAFullPage) {
  on_posix = GetParam();
  store_table(patch(4));
  power_up();
  run_for(500'000);
  EXPECT_TRUE(kept().empty());
  for (std::uint16_t revision = 1; revision <= 14; ++revision) {
    ASSERT_TRUE(write(revision));
    EXPECT_EQ(kept(), value_of(revision));
  }
  power_up();
  run_for(500'000);
  EXPECT_EQ(kept(), value_of(14));
  EXPECT_EQ(modules(), 4);
  ASSERT_TRUE(flash_table(patch(6)));
  EXPECT_TRUE(kept().empty()) << "a table of other modules";
  if (!on_posix) expect_no_violation();
}

INSTANTIATE_TEST_SUITE_P(Boards, CalibrationOfATable, ::testing::Bool(),
                         [](const auto& tested) { return std::string(tested.param ? "posix" : "machine"); });

// The cut falls in the present page or, when that is full, in the erase, the table and the calibration of the other
// one.
TEST_F(CalibrationCut, InEachFlashOperationLeavesTheOldOrTheNewOne) {
  const FlashChip empty = flash;
  for (const std::uint16_t before : {std::uint16_t{1}, std::uint16_t{12}}) {
    flash = empty;
    store_table(patch(4));
    power_up();
    run_for(500'000);
    for (std::uint16_t revision = 1; revision <= before; ++revision) ASSERT_TRUE(write(revision));
    const FlashChip chip = flash;
    flash.operations = 0;
    ASSERT_TRUE(write(20));
    const std::uint64_t operations = flash.operations;
    EXPECT_EQ(operations, before == 1 ? 20U : 1U + 10 + 20 + 2);  // The operations are erase, table, record and commit.
    for (std::uint64_t cut = 0; cut < operations; ++cut) {
      SCOPED_TRACE(testing::Message() << before << " before, cut in operation " << cut);
      flash = chip;
      flash.operations = 0;
      power_up();
      run_for(500'000);
      flash.cut_power_after(cut);
      EXPECT_THROW((void)write(20), sim::PowerLost);
      flash.cut_at = ~std::uint64_t{0};
      power_up();
      run_for(100'000);
      EXPECT_EQ(kept(), value_of(before));  // The unit with the CRC is torn, too.
      EXPECT_EQ(modules(), 4);
      ASSERT_TRUE(write(30));
      EXPECT_EQ(kept(), value_of(30));
      expect_no_violation();
    }
  }
}

}  // namespace
}  // namespace triskin::machine
