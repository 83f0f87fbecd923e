// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/storage/table_store.hpp"

#include <gtest/gtest.h>

#include "calibration_value.hpp"
#include "flash_double.hpp"
#include "triskin/logic/diagnostics/fault_memory.hpp"

namespace triskin::fw {
namespace {

using Flash = test::FlashDouble<FlashArea>;
using Tear = Flash::Tear;

layout::PatchImage table(std::uint64_t design, std::uint8_t modules, std::uint8_t node = 1) {
  layout::PatchImage image;
  image.design_id = design;
  image.node_address = node;
  image.module_count = modules;
  for (std::uint8_t k = 0; k < modules; ++k) {
    const auto small = [](int x) { return static_cast<std::uint8_t>(x); };
    image.modules[k] = {k,
                        small(k / 4),
                        small(k % 4),
                        0,
                        k == 0 ? layout::kNoParent : small((k - 1) / 2),
                        k == 0 ? layout::kCable : small(k % 2 == 1 ? 1 : 2)};
  }
  return image;
}

std::vector<std::uint8_t> bytes_of(const layout::PatchImage& image) {
  std::vector<std::uint8_t> bytes(layout::kMaxImageBytes);
  bytes.resize(layout::encode(image, bytes).value());
  return bytes;
}

Status flash_table(TableStore& store, const std::vector<std::uint8_t>& bytes, std::uint8_t node = 1) {
  store.begin_download(bytes.size());
  if (const Status s = store.append(bytes); s != Status::kOk) return s;
  return store.activate(node);
}

TEST(TableStore, StartsEmptyAndKeepsWhatIsActivated) {
  Flash flash;
  TableStore store(flash);
  store.load();
  EXPECT_EQ(store.status(), Status::kEmpty);
  EXPECT_TRUE(store.active_bytes().empty());
  for (std::uint8_t n = 1; n <= 16; ++n) {
    const auto bytes = bytes_of(table(n, n));
    ASSERT_EQ(flash_table(store, bytes), Status::kOk);
    EXPECT_TRUE(std::ranges::equal(store.active_bytes(), bytes));
    EXPECT_EQ(store.sequence(), n);
    TableStore again(flash);  // A new store reads the flash as after power-up.
    again.load();
    ASSERT_TRUE(again.has_table());
    EXPECT_EQ(again.table(), table(n, n));
  }
}

TEST(TableStore, RefusesWithoutTouchingFlash) {
  Flash flash;
  TableStore store(flash);
  store.load();
  ASSERT_EQ(flash_table(store, bytes_of(table(1, 16))), Status::kOk);
  const auto before = flash.raw();
  auto bytes = bytes_of(table(2, 5));
  EXPECT_EQ(flash_table(store, bytes_of(table(2, 5, 9))), Status::kWrongTarget);
  bytes[40] ^= 1;
  EXPECT_EQ(flash_table(store, bytes), Status::kBadCrc);
  bytes = bytes_of(table(2, 5));
  bytes[4] = 2;
  EXPECT_EQ(flash_table(store, bytes), Status::kBadVersion);
  bytes = bytes_of(table(2, 5));
  bytes.push_back(0xFF);  // The data is longer than the image states.
  EXPECT_EQ(flash_table(store, bytes), Status::kBadLength);
  bytes = bytes_of(table(2, 5));
  store.begin_download(bytes.size());
  ASSERT_EQ(store.append(Bytes(bytes).first(50)), Status::kOk);
  EXPECT_EQ(store.activate(1), Status::kBadLength);  // Only half of it is sent.
  EXPECT_EQ(store.append(bytes), Status::kNoSpace);  // Too much of it is sent.
  EXPECT_EQ(flash.raw(), before);
  EXPECT_EQ(store.table(), table(1, 16));
}

TEST(TableStore, AFlashThatRefusesLeavesTheOldTable) {
  Flash flash;
  TableStore store(flash);
  store.load();
  ASSERT_EQ(flash_table(store, bytes_of(table(1, 3))), Status::kOk);
  flash.refuse(true);
  EXPECT_EQ(flash_table(store, bytes_of(table(2, 4))), Status::kFlashFailed);
  EXPECT_EQ(store.table(), table(1, 3));
}

// Power fails in every operation of an activation in turn: before it, in its middle, and after it.
TEST(TableStore, APowerCutLeavesTheOldOrTheNewTable) {
  const auto next = bytes_of(table(99, 16));
  for (int history = 0; history <= 2; ++history) {  // The history is nothing, one slot, or both slots in use.
    for (const Tear tear : {Tear::kNothing, Tear::kHalf, Tear::kAll}) {
      int cuts = 0;
      for (bool completed = false; !completed; ++cuts) {
        ASSERT_LT(cuts, 100);
        Flash flash;
        TableStore store(flash);
        store.load();
        for (int h = 1; h <= history; ++h) {
          ASSERT_EQ(flash_table(store, bytes_of(table(static_cast<std::uint64_t>(h), 8))), Status::kOk);
        }
        flash.cut_after(cuts, tear);
        try {
          EXPECT_EQ(flash_table(store, next), Status::kOk);
          completed = true;
        } catch (const sim::PowerLost&) {
        }
        flash.never_cut();
        TableStore after(flash);
        after.load();
        SCOPED_TRACE(testing::Message() << "history " << history << ", cut " << cuts << ", tear "
                                        << static_cast<int>(tear));
        const bool is_new = after.has_table() && after.table() == table(99, 16);
        const bool is_old = history == 0
                                ? !after.has_table()
                                : after.has_table() && after.table() == table(static_cast<std::uint64_t>(history), 8);
        EXPECT_TRUE(is_new || is_old);
        EXPECT_TRUE(is_new || !completed);
        EXPECT_EQ(flash_table(after, next), Status::kOk);  // Another run completes the work.
        EXPECT_EQ(after.table(), table(99, 16));
      }
      EXPECT_EQ(cuts, 1 + 224 / 8 + 2 + 1);  // The sum is erase, image, commit record, and the run without a cut.
    }
  }
}

TEST(TableStore, ADamagedSlotGivesWayToTheOther) {
  Flash flash;
  TableStore store(flash);
  store.load();
  ASSERT_EQ(flash_table(store, bytes_of(table(1, 3))), Status::kOk);
  ASSERT_EQ(flash_table(store, bytes_of(table(2, 4))), Status::kOk);
  flash.raw()[Flash::kPage + 33] ^= 0x10;  // This is the newer slot.
  TableStore after(flash);
  after.load();
  ASSERT_TRUE(after.has_table());
  EXPECT_EQ(after.table(), table(1, 3));
}

// Returns what a controller keeps after power-up; empty if it has no calibration.
std::vector<std::uint8_t> calibration_in(Flash& flash) {
  TableStore store(flash);
  store.load();
  return {store.calibration().begin(), store.calibration().end()};
}

std::vector<std::uint8_t> calibration(const layout::PatchImage& table, std::uint16_t revision) {
  return test::bytes_of(test::calibration_of(table, revision));
}

// A record of 16 modules takes 8 + 496 + 8 bytes: three fit beside the table, and the fourth goes to the other slot.
TEST(KeptCalibration, IsTheNewestAndOutlivesAFullPage) {
  Flash flash;
  TableStore store(flash);
  store.load();
  const auto patch = table(7, 16);
  EXPECT_EQ(store.set_calibration(calibration(patch, 1)), Status::kEmpty);
  ASSERT_EQ(flash_table(store, bytes_of(patch)), Status::kOk);
  EXPECT_TRUE(store.calibration().empty());
  for (std::uint16_t revision = 1; revision <= 12; ++revision) {
    const auto value = calibration(patch, revision);
    ASSERT_EQ(store.set_calibration(value), Status::kOk);
    EXPECT_TRUE(std::ranges::equal(store.calibration(), value));
    EXPECT_EQ(calibration_in(flash), value);
    EXPECT_EQ(store.table(), patch);
    EXPECT_EQ(store.sequence(), 1U + (revision - 1U) / 3) << "each third one finds the page full";
    const int operations = flash.operations();
    EXPECT_EQ(store.set_calibration(value), Status::kOk);
    EXPECT_EQ(flash.operations(), operations) << "nothing is written twice";
  }
}

TEST(KeptCalibration, IsDeletedByOneWithoutModules) {
  Flash flash;
  TableStore store(flash);
  store.load();
  const auto patch = table(7, 5);
  ASSERT_EQ(flash_table(store, bytes_of(patch)), Status::kOk);
  ASSERT_EQ(store.set_calibration(calibration(patch, 1)), Status::kOk);
  wire::Calibration none = test::calibration_of(patch, 1);
  none.count = 0;
  EXPECT_EQ(store.set_calibration(test::bytes_of(none)), Status::kOk);
  EXPECT_TRUE(store.calibration().empty());
  EXPECT_TRUE(calibration_in(flash).empty());
}

TEST(KeptCalibration, OfOtherModulesIsRefused) {
  Flash flash;
  TableStore store(flash);
  store.load();
  const auto patch = table(7, 5);
  ASSERT_EQ(flash_table(store, bytes_of(patch)), Status::kOk);
  ASSERT_EQ(store.set_calibration(calibration(patch, 1)), Status::kOk);
  const auto before = flash.raw();
  EXPECT_EQ(store.set_calibration(calibration(table(8, 5), 2)), Status::kWrongTarget);
  EXPECT_EQ(store.set_calibration(calibration(table(7, 6), 2)), Status::kWrongTarget) << "a place without a module";
  auto damaged = calibration(patch, 2);
  damaged[0] = 2;
  EXPECT_EQ(store.set_calibration(damaged), Status::kBadVersion);
  EXPECT_EQ(flash.raw(), before);
  flash.refuse(true);
  EXPECT_EQ(store.set_calibration(calibration(patch, 2)), Status::kFlashFailed);
  EXPECT_EQ(calibration_in(flash), calibration(patch, 1));
}

// A new table keeps the measurements of its modules if they are at the same places.
TEST(KeptCalibration, GoesWithTheSameModulesToANewTable) {
  auto joined = table(7, 5), moved = table(7, 5), fewer = table(7, 4), named = table(7, 5);
  joined.modules[4].rotation = 2;
  std::swap(moved.modules[3].address, moved.modules[2].address);
  named.modules[4].module_id = 99;
  for (const auto& [next, stays] : {std::pair{table(7, 5), true},
                                    {joined, true},
                                    {moved, false},
                                    {fewer, false},
                                    {named, false},
                                    {table(8, 5), false}}) {
    Flash flash;
    TableStore store(flash);
    store.load();
    ASSERT_EQ(flash_table(store, bytes_of(table(7, 5))), Status::kOk);
    const auto value = calibration(table(7, 5), 1);
    ASSERT_EQ(store.set_calibration(value), Status::kOk);
    ASSERT_EQ(flash_table(store, bytes_of(next)), Status::kOk);
    EXPECT_EQ(store.table(), next);
    EXPECT_EQ(calibration_in(flash), stays ? value : std::vector<std::uint8_t>{});
  }
}

// Power fails in every operation in turn: of a record behind another, of one for which the page is full, and of a table
// that takes the calibration along.
TEST(KeptCalibration, APowerCutLeavesTheOldOrTheNewOne) {
  const auto patch = table(7, 16);
  for (const int before : {0, 1, 3}) {
    for (const Tear tear : {Tear::kNothing, Tear::kHalf, Tear::kAll}) {
      int cuts = 0;
      for (bool completed = false; !completed; ++cuts) {
        ASSERT_LT(cuts, 200);
        SCOPED_TRACE(testing::Message() << before << " before, cut " << cuts << ", tear " << static_cast<int>(tear));
        Flash flash;
        TableStore store(flash);
        store.load();
        ASSERT_EQ(flash_table(store, bytes_of(patch)), Status::kOk);
        for (int k = 1; k <= before; ++k)
          ASSERT_EQ(store.set_calibration(calibration(patch, static_cast<std::uint16_t>(k))), Status::kOk);
        const auto old = calibration_in(flash), next = calibration(patch, 9);
        flash.cut_after(cuts, tear);
        try {
          EXPECT_EQ(store.set_calibration(next), Status::kOk);
          completed = true;
        } catch (const sim::PowerLost&) {
        }
        flash.never_cut();
        const auto now = calibration_in(flash);
        EXPECT_TRUE(now == next || (!completed && now == old));
        TableStore after(flash);
        after.load();
        EXPECT_EQ(after.table(), patch);
        ASSERT_EQ(after.set_calibration(calibration(patch, 10)), Status::kOk);  // The record can be written again.
        EXPECT_EQ(calibration_in(flash), calibration(patch, 10));
      }
      // A record has head, value and CRC in units of 8 bytes; a full page adds erase, table and commit record.
      EXPECT_EQ(cuts, 1 + 62 + 1 + (before == 3 ? 1 + 28 + 2 : 0) + 1);
    }
  }
}

TEST(KeptCalibration, APowerCutInANewTableLeavesTableAndCalibrationTogether) {
  const auto old = table(7, 16);
  auto next = old;
  next.modules[15].rotation = 1;
  const auto value = calibration(old, 1);
  int cuts = 0;
  for (bool completed = false; !completed; ++cuts) {
    ASSERT_LT(cuts, 200);
    Flash flash;
    TableStore store(flash);
    store.load();
    ASSERT_EQ(flash_table(store, bytes_of(old)), Status::kOk);
    ASSERT_EQ(store.set_calibration(value), Status::kOk);
    flash.cut_after(cuts, Tear::kHalf);
    try {
      EXPECT_EQ(flash_table(store, bytes_of(next)), Status::kOk);
      completed = true;
    } catch (const sim::PowerLost&) {
    }
    flash.never_cut();
    TableStore after(flash);
    after.load();
    EXPECT_TRUE(after.table() == next || (!completed && after.table() == old)) << cuts;
    EXPECT_TRUE(std::ranges::equal(after.calibration(), value)) << cuts;
  }
  EXPECT_EQ(cuts, 1 + 28 + 64 + 2 + 1);
}

TEST(NodeAddress, IsKeptOverManyChangesAndPowerCuts) {
  Flash flash;
  TableStore store(flash);
  store.load();
  EXPECT_EQ(store.node_address(), 1);
  EXPECT_EQ(store.set_node_address(0), Status::kOutOfRange);
  EXPECT_EQ(store.set_node_address(127), Status::kOutOfRange);
  std::uint8_t old = 1;
  for (int change = 0; change < 700; ++change) {  // This many changes fill both pages.
    const auto wanted =
        static_cast<std::uint8_t>(layout::kFirstNode + static_cast<std::size_t>(change * 37 + 1) % layout::kMaxNodes);
    if (change % 3 == 0) flash.cut_after(change % 2, change % 5 == 0 ? Tear::kHalf : Tear::kNothing);
    try {
      ASSERT_EQ(store.set_node_address(wanted), Status::kOk);
    } catch (const sim::PowerLost&) {
    }
    flash.never_cut();
    TableStore after(flash);
    after.load();
    ASSERT_TRUE(after.node_address() == wanted || after.node_address() == old) << change;
    store.load();
    old = store.node_address();
  }
}

TEST(FaultMemory, SurvivesPowerLossUntilItIsCleared) {
  Flash flash;
  FaultMemory faults(flash);
  faults.load();
  faults.note(table_row(3), wire::ModuleState::kAbsent, {1500, 40});
  faults.note(table_row(3), wire::ModuleState::kOk, {1600, 43});
  faults.note(table_row(3), wire::ModuleState::kAbsent, {9000, 240});  // The first occurrence is kept.
  FaultMemory after(flash);
  after.load();
  const auto frame = after.snapshot(0x920003);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->fault, (wire::FaultRecord{{wire::ModuleState::kAbsent, 3}, wire::fault_status::kConfirmed}));
  EXPECT_EQ(frame->freeze, (wire::Freeze{1500, 40}));
  EXPECT_FALSE(after.snapshot(0x920004));
  EXPECT_FALSE(after.snapshot(0x910003));  // The state "ok" is no fault.
  EXPECT_FALSE(after.snapshot(0x92FF03));
  EXPECT_TRUE(after.clear());
  after.load();
  EXPECT_FALSE(after.snapshot(0x920003));
}

// An erase would stop the loop for 22 ms, and the pages of a new board are erased.
TEST(FaultMemory, TheFirstFaultOfANewBoardErasesNothing) {
  Flash flash;
  FaultMemory faults(flash);
  faults.load();
  faults.note(table_row(3), wire::ModuleState::kAbsent, {1500, 40});
  EXPECT_GT(flash.operations(), 0);
  EXPECT_EQ(flash.erases(), 0);
}

// What another program left in the flash is no record, and nothing can be programmed over it.
TEST(FaultMemory, PagesOfAnotherProgramAreErasedFirst) {
  Flash flash;
  const std::vector<std::uint8_t> zeros(flash.size_bytes());
  ASSERT_TRUE(flash.program(0, zeros));
  FaultMemory faults(flash);
  faults.load();
  faults.note(table_row(3), wire::ModuleState::kAbsent, {1500, 40});
  FaultMemory after(flash);
  after.load();
  EXPECT_TRUE(after.snapshot(0x920003));
}

// Where the memory was cleared, the page that follows is not blank: it has to be erased, and the fault is kept.
TEST(FaultMemory, APageThatIsNotBlankIsErasedFirst) {
  Flash flash;
  FaultMemory faults(flash);
  faults.load();
  for (int round = 0; round < 4; ++round) {
    faults.note(table_row(3), wire::ModuleState::kAbsent, {1500, 40});
    ASSERT_TRUE(faults.clear());
  }
  EXPECT_GT(flash.erases(), 0);
  faults.note(table_row(5), wire::ModuleState::kAbsent, {7, 8});
  FaultMemory after(flash);
  after.load();
  ASSERT_TRUE(after.snapshot(0x920005));
  EXPECT_EQ(after.snapshot(0x920005)->freeze, (wire::Freeze{7, 8}));
  EXPECT_FALSE(after.snapshot(0x920003));
}

TEST(FaultMemory, ALooseContactWritesOnce) {
  Flash flash;
  FaultMemory faults(flash);
  faults.load();
  faults.note(table_row(0), wire::ModuleState::kAbsent, {});
  const int operations = flash.operations();
  for (std::uint32_t k = 0; k < 1000; ++k)
    faults.note(table_row(0), k % 2 == 0 ? wire::ModuleState::kOk : wire::ModuleState::kAbsent, {k, k});
  EXPECT_EQ(flash.operations(), operations);
}

TEST(FaultMemory, APowerCutLosesAtMostTheLastEntry) {
  for (const Tear tear : {Tear::kNothing, Tear::kHalf, Tear::kAll}) {
    for (int cut = 0; cut < 400; ++cut) {
      Flash flash;
      FaultMemory faults(flash);
      faults.load();
      faults.note(table_row(15), wire::ModuleState::kFrozen, {7, 7});
      flash.cut_after(cut, tear);
      std::size_t noted = 0;
      try {
        for (std::uint8_t m = 0; m < 15; ++m) {
          for (std::uint8_t s = 2; s < wire::kModuleStateCount; ++s, ++noted)
            faults.note(table_row(m), wire::to_module_state(s).value(), {m, s});
        }
      } catch (const sim::PowerLost&) {
      }
      flash.never_cut();
      FaultMemory after(flash);
      after.load();
      EXPECT_TRUE(after.snapshot(0x96000F));
      std::array<std::uint8_t, 512> out{};
      ByteWriter w(out);
      after.report(wire::fault_status::kConfirmed, w);
      EXPECT_GE(w.size() / 4, noted + 1) << "cut " << cut;
      EXPECT_LE(w.size() / 4, noted + 2);
    }
  }
}

wire::Crash a_crash(std::uint32_t number) {
  wire::Crash c;
  c.cause = wire::CrashCause::kFault;
  c.pc = 0x08001234;
  c.lr = 0x08005677;
  c.uptime_ms = 1500;
  c.number = number;
  return c;
}

// The crash is stored beside the faults of modules until all is cleared; faults of another table's rows are cleared
// separately.
TEST(FaultMemory, KeepsTheLastCrashUntilItIsCleared) {
  Flash flash;
  FaultMemory faults(flash);
  faults.load();
  EXPECT_TRUE(faults.note_crash(a_crash(1)));
  faults.note(table_row(3), wire::ModuleState::kAbsent, {1500, 40});
  EXPECT_TRUE(faults.note_crash(a_crash(2)));
  const auto after = [&] {
    FaultMemory again(flash);
    again.load();
    return again.crash();
  };
  EXPECT_EQ(after(), a_crash(2));
  EXPECT_TRUE(faults.clear_modules());
  EXPECT_EQ(after(), a_crash(2));
  EXPECT_FALSE(faults.snapshot(wire::FaultCode{wire::ModuleState::kAbsent, 3}.dtc()));
  EXPECT_TRUE(faults.clear());
  EXPECT_FALSE(after());
}

// Pages fill up: 127 records beside the head, five per crash.
TEST(FaultMemory, CrashesFillOnePageAfterTheOther) {
  Flash flash;
  FaultMemory faults(flash);
  faults.load();
  for (std::uint32_t k = 1; k <= 100; ++k) {
    ASSERT_TRUE(faults.note_crash(a_crash(k)));
    FaultMemory again(flash);
    again.load();
    ASSERT_EQ(again.crash(), a_crash(k));
  }
}

// Power fails in each operation of the second crash: either the first one is kept, or the second.
TEST(FaultMemory, APowerCutLosesAtMostTheNewCrash) {
  for (const Tear tear : {Tear::kNothing, Tear::kHalf, Tear::kAll}) {
    int cuts = 0;
    for (int operation = 0;; ++operation, ++cuts) {
      Flash flash;
      FaultMemory faults(flash);
      faults.load();
      ASSERT_TRUE(faults.note_crash(a_crash(1)));
      flash.cut_after(operation, tear);
      bool cut = false;
      try {
        (void)faults.note_crash(a_crash(2));
      } catch (const sim::PowerLost&) {
        cut = true;
      }
      flash.never_cut();
      FaultMemory after(flash);
      after.load();
      ASSERT_TRUE(after.crash()) << operation;
      EXPECT_TRUE(*after.crash() == a_crash(1) || *after.crash() == a_crash(2)) << operation;
      EXPECT_TRUE(after.note_crash(a_crash(3))) << operation;
      FaultMemory last(flash);
      last.load();
      EXPECT_EQ(last.crash(), a_crash(3)) << operation;
      if (!cut) break;
    }
    EXPECT_EQ(cuts, 10) << "two units a record";
  }
}

}  // namespace
}  // namespace triskin::fw
