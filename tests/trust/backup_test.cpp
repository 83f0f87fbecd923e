// SPDX-License-Identifier: GPL-3.0-or-later
// The content of boards is saved to a file and written back, or refused before the first byte.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "shared_skin.hpp"
#include "triskin/base/files.hpp"
#include "triskin/deploy/board_backup.hpp"
#include "triskin/diagnose/verify.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/controller_calibration.hpp"
#include "triskin/session/patch_table.hpp"

namespace triskin::deploy {
namespace {

namespace fs = std::filesystem;
using test::SharedSkin;
using test::strip;
using test::strip_scene;

class Backups : public testing::Test {
 protected:
  void SetUp() override {
    file_ = fs::temp_directory_path() / fmt::format("triskin_backup.{}.json", ::getpid());
    hub_.flash();
    bus_.listen(bus_.now_us() + 3'000'000);  // Offsets are searched and stored by now.
  }
  void TearDown() override { fs::remove(file_); }

  [[nodiscard]] std::vector<deploy::BoardBackup> read_of(const std::string& text) const {
    write_file_atomically(file_, text);
    return deploy::read_backup(file_);
  }
  [[nodiscard]] std::string error_of(const std::string& text) const {
    try {
      (void)read_of(text);
    } catch (const InputError& e) {
      return e.what();
    }
    return {};
  }
  std::string refusal(const std::vector<deploy::BoardBackup>& boards, const deploy::RestoreOptions& options = {}) {
    const std::uint64_t before = operations();
    try {
      (void)deploy::restore_boards(bus_, boards, options);
    } catch (const Error& e) {
      EXPECT_EQ(operations(), before);
      return e.what();
    }
    return {};
  }
  std::uint64_t operations() {
    std::uint64_t n = 0;
    for (std::size_t p = 0; p < hub_.skin().controllers(); ++p) n += hub_.skin().flash(p).operations();
    return n;
  }

  fs::path file_;
  SharedSkin hub_{strip_scene(12, 4)};  // There are three controllers.
  SharedSkin::Client link_{hub_};
  session::Bus bus_{link_};
};

TEST_F(Backups, keep_every_value_that_the_protocol_reads) {
  const auto boards = deploy::save_boards(bus_, {});
  ASSERT_EQ(boards.size(), 3U);
  for (int p = 0; p < 3; ++p) {
    const deploy::BoardBackup& b = boards[static_cast<std::size_t>(p)];
    EXPECT_EQ(b.node_address, p + 1);
    EXPECT_EQ(b.table, session::bytes_of(session::image_of(hub_.design(), layout::PatchIndex{p})));
    for (const wire::Identifier& row : wire::kIdentifiers) {
      // Simulated controllers are not started from a slot, so they report no image; none is calibrated or has crashed.
      const bool silent =
          row.id == wire::did::kImageState || row.id == wire::did::kCalibration || row.id == wire::did::kCrash;
      if (row.access == wire::Access::kFreeze || silent) continue;
      EXPECT_TRUE(b.values.contains(row.id)) << std::hex << row.id;
    }
    EXPECT_EQ(b.values.at(wire::did::kOffsets).size(), 5U + 16U * 4);  // There are 4 modules with 16 bytes each.
  }
  const auto again = read_of(deploy::backup_text(boards));
  ASSERT_EQ(again.size(), 3U);
  EXPECT_EQ(deploy::backup_text(again), deploy::backup_text(boards));
  EXPECT_EQ(again[2].values, boards[2].values);
}

TEST_F(Backups, carry_the_calibration_that_is_kept_for_a_board) {
  auto boards = deploy::save_boards(bus_, {});
  EXPECT_EQ(deploy::backup_text(boards).find("calibration"), std::string::npos)
      << "files without one are what they were";
  design::BoardCalibration calibration{boards[1].serial,
                                       hub_.design().design_id,
                                       layout::PatchIndex{1},
                                       3,
                                       "2026-11-22T17:30:00Z",
                                       wire::CalibrationMethod::kRamp,
                                       40.0,
                                       38.97,
                                       {}};
  calibration.places.push_back({2, 1, {}});
  calibration.places[0].taxels[4] = {151.25, 0.125, 0.0625};
  boards[1].calibration = calibration;
  const auto again = read_of(deploy::backup_text(boards));
  EXPECT_FALSE(again[0].calibration);
  ASSERT_TRUE(again[1].calibration);
  EXPECT_EQ(*again[1].calibration, calibration);
  boards[1].calibration->serial = boards[0].serial;
  EXPECT_NE(error_of(deploy::backup_text(boards)).find("is not that of this controller"), std::string::npos);
}

// The calibration that the controllers keep goes with the table: into the file, back after another design, and onto a
// new board.
TEST_F(Backups, bring_the_calibration_back_that_a_controller_kept) {
  const auto claims = bus_.discover();
  design::BoardCalibration calibration{session::to_text(claims.at(1).unique_id),
                                       hub_.design().design_id,
                                       layout::PatchIndex{1},
                                       3,
                                       "2026-11-22T17:30:00Z",
                                       wire::CalibrationMethod::kRamp,
                                       40.0,
                                       38.97,
                                       {}};
  const auto patch =
      static_cast<std::size_t>(design::patch_at(hub_.design(), layout::NodeAddress{claims[1].node_address}));
  for (const auto& routed : hub_.design().patches[patch].modules) {
    calibration.places.push_back({routed.line, routed.address, {}});
    calibration.places.back().taxels[4] = {151.25, 0.125, 0.0625};
  }
  ASSERT_TRUE(session::keep_in_controller(bus_, claims[1], calibration));
  const auto kept = [&] { return session::Controller(bus_, claims[1].node_address).calibration(); };
  const auto boards = read_of(deploy::backup_text(deploy::save_boards(bus_, {})));
  EXPECT_EQ(kept(), session::to_wire(calibration));
  EXPECT_EQ(session::kept_revisions(bus_), (std::map<std::string, int>{{calibration.serial, 3}}));
  deploy::FlashOptions options;
  options.take_over = true;
  (void)flash(bus_, strip(9, 3), options);
  EXPECT_FALSE(kept()) << "modules of another design";
  int calibrated = 0;
  for (const deploy::RestoredBoard& r : deploy::restore_boards(bus_, boards, {})) calibrated += r.calibrated ? 1 : 0;
  EXPECT_EQ(calibrated, 1);
  EXPECT_EQ(kept(), session::to_wire(calibration));
  for (const deploy::RestoredBoard& r : deploy::restore_boards(bus_, boards, {})) EXPECT_TRUE(r.equal && !r.calibrated);
  auto damaged = boards;
  for (deploy::BoardBackup& b : damaged) {
    if (const auto value = b.values.find(wire::Calibration::kId); value != b.values.end()) value->second[0] = 2;
  }
  EXPECT_NE(error_of(deploy::backup_text(damaged)).find("keeps a calibration that is none"), std::string::npos);
}

TEST_F(Backups, remember_faults_and_when_they_came) {
  hardware::Scene scene = strip_scene(4, 4);
  hardware::Fault away;
  away.module = layout::ModuleId{2};
  away.from_us = 3'000'000;
  scene.faults.push_back(away);
  SharedSkin skin(std::move(scene));
  skin.flash();
  SharedSkin::Client link(skin);
  session::Bus bus(link);
  bus.listen(6'000'000);
  const auto boards = read_of(deploy::backup_text(deploy::save_boards(bus, {})));
  ASSERT_EQ(boards.size(), 1U);
  ASSERT_EQ(boards[0].faults.size(), 1U);
  EXPECT_EQ(boards[0].faults[0].code, 0x920002U);  // The state is absent, the row is 2.
  EXPECT_TRUE(wire::FreezeFrame::decode(boards[0].faults[0].noted));
}

TEST_F(Backups, bring_the_tables_of_a_design_back) {
  const auto boards = read_of(deploy::backup_text(deploy::save_boards(bus_, {})));
  deploy::FlashOptions options;
  options.take_over = true;
  (void)flash(bus_, strip(9, 3), options);
  ASSERT_FALSE(diagnose::verify(bus_, hub_.design(), {}).findings.empty());
  const auto restored = deploy::restore_boards(bus_, boards, {});
  ASSERT_EQ(restored.size(), 3U);
  for (const deploy::RestoredBoard& r : restored) EXPECT_TRUE(r.written);
  bus_.listen(bus_.now_us() + 3'000'000);
  EXPECT_TRUE(diagnose::verify(bus_, hub_.design(), {}).findings.empty());
  for (const deploy::RestoredBoard& r : deploy::restore_boards(bus_, boards, {})) EXPECT_TRUE(r.equal);
}

TEST_F(Backups, come_back_one_after_the_other_when_asked_for) {
  const auto kept = deploy::save_boards(bus_, {});
  deploy::FlashOptions other;
  other.take_over = true;
  const auto restore_us = [&](int per_wire) {
    (void)flash(bus_, strip(9, 3), other);
    deploy::RestoreOptions options;
    options.per_wire = per_wire;
    const std::uint64_t before = bus_.now_us();
    for (const deploy::RestoredBoard& r : deploy::restore_boards(bus_, kept, options)) EXPECT_TRUE(r.written);
    return bus_.now_us() - before;
  };
  // An erase takes 22 ms and is the longest part; in parallel, three boards wait for it once.
  EXPECT_GT(restore_us(1), restore_us(3) + 2 * 22'000);
}

TEST_F(Backups, put_a_new_board_in_the_place_of_a_broken_one) {
  const auto boards = deploy::save_boards(bus_, {});
  hardware::Scene scene = strip_scene(12, 4);
  scene.board_seed = 11;  // These are other boards, which were never flashed.
  SharedSkin other(std::move(scene));
  SharedSkin::Client link(other);
  session::Bus bus(link);
  EXPECT_THROW((void)deploy::restore_boards(bus, boards, {}), DeviceError);
  deploy::RestoreOptions options;
  for (std::size_t p = 0; p < 3; ++p)
    options.onto[boards[p].serial] =
        session::to_text(hardware::unique_id_of(other.skin().scene(), layout::PatchIndex{p}));
  options.dry_run = true;
  for (const deploy::RestoredBoard& r : deploy::restore_boards(bus, boards, options)) EXPECT_FALSE(r.written);
  for (const auto& c : bus.discover()) EXPECT_FALSE(c.has_table);
  options.dry_run = false;
  EXPECT_EQ(deploy::restore_boards(bus, boards, options).size(), 3U);
  bus.listen(bus.now_us() + 3'000'000);
  EXPECT_TRUE(diagnose::verify(bus, other.design(), {}).findings.empty());
}

TEST_F(Backups, are_refused_for_another_kind_of_board_or_a_taken_address) {
  const auto boards = deploy::save_boards(bus_, {});
  auto other = boards;
  other[1].values[wire::did::kPartNumber] = {'T', 'R', 'I', 'S', 'K', 'I', 'N', '2'};
  const std::string kind = refusal(other);
  EXPECT_NE(kind.find("\"TRISKIN1\""), std::string::npos) << kind;
  EXPECT_NE(kind.find("\"TRISKIN2\""), std::string::npos) << kind;
  EXPECT_NE(kind.find(boards[1].serial), std::string::npos) << kind;
  deploy::RestoreOptions swap;
  swap.onto[boards[0].serial] = boards[1].serial;
  EXPECT_NE(refusal({boards[0]}, swap).find("which is not in the file, has node address 1"), std::string::npos);
  EXPECT_NE(refusal(boards, swap).find("what two boards held"), std::string::npos);
  swap.onto = {{"00112233445566778899AABB", boards[1].serial}};
  EXPECT_NE(refusal(boards, swap).find("keeps no controller"), std::string::npos);
}

TEST_F(Backups, that_were_cut_or_changed_are_refused) {
  const std::string text = deploy::backup_text(deploy::save_boards(bus_, {}));
  for (std::size_t n = 0; n + 2 < text.size(); n += 97) EXPECT_NE(error_of(text.substr(0, n)), "") << n;
  int refused = 0, tried = 0;
  for (std::size_t at = 0; at < text.size(); at += 53) {
    if (!std::isxdigit(static_cast<unsigned char>(text[at]))) continue;
    std::string changed = text;
    changed[at] = changed[at] == '7' ? '8' : '7';
    ++tried;
    refused += error_of(changed).empty() ? 0 : 1;
  }
  EXPECT_GT(tried, 50);
  EXPECT_EQ(refused, tried);
}

// The data is no table, but its CRC fits, so the second check must refuse it.
TEST_F(Backups, of_something_else_than_a_table_are_refused) {
  auto boards = deploy::save_boards(bus_, {});
  boards[0].table[40] ^= 1;
  EXPECT_NE(error_of(deploy::backup_text(boards)).find("/boards/0/table"), std::string::npos);
  boards = deploy::save_boards(bus_, {});
  boards[0].node_address = 9;
  EXPECT_NE(error_of(deploy::backup_text(boards)).find("is for node address 1, the board had 9"), std::string::npos);
}

}  // namespace
}  // namespace triskin::deploy
