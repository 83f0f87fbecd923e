// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <bit>

#include "support/device_fixture.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::diagnose {

using test::fault;
using test::Fixture;

namespace {

using hardware::FaultKind;

VerifyResult verify_with(std::vector<hardware::Fault> faults, int modules = 6, int per_patch = 16, bool touch = true) {
  Fixture fixture(modules, per_patch, std::move(faults));
  fixture.flash();
  return fixture.verify(touch);
}

void expect_one(const VerifyResult& r, FindingKind kind, int module, int other = -1) {
  ASSERT_EQ(r.findings.size(), 1U) << (r.findings.empty() ? "none"
                                                          : r.findings[0].text + " | " + r.findings.back().text);
  const Finding& f = r.findings[0];
  EXPECT_EQ(f.kind, kind) << f.text;
  EXPECT_EQ(f.module, module) << f.text;
  EXPECT_EQ(f.other, other) << f.text;
  if (module >= 0) {
    EXPECT_NE(f.text.find("module " + std::to_string(module)), std::string::npos) << f.text;
  }
  EXPECT_FALSE(f.remedy.empty());
}

TEST(Verify, a_healthy_patch_has_no_findings) {
  const VerifyResult r = verify_with({}, 20, 8);
  EXPECT_TRUE(r.findings.empty()) << r.findings[0].text;
  EXPECT_EQ(r.modules_ok, 20);
  EXPECT_EQ(r.touched, 20);
}

TEST(Verify, names_a_board_that_was_never_flashed) {
  Fixture fixture(6);
  const VerifyResult r = fixture.verify();
  expect_one(r, FindingKind::kNotFlashed, -1);
  EXPECT_EQ(r.findings[0].patch, 0);
  EXPECT_NE(r.findings[0].remedy.find("triskin flash"), std::string::npos);
  EXPECT_EQ(r.modules_ok, 0);
}

TEST(Verify, names_a_table_of_another_design) {
  Fixture fixture(6);
  fixture.flash();
  design::Design other = test::strip(6);
  std::swap(other.patches[0].modules[1].address, other.patches[0].modules[2].address);
  other.design_id = design::design_id_of(other);
  const VerifyResult r = verify(fixture.bus(), other, {});
  expect_one(r, FindingKind::kWrongTable, -1);
}

wire::Crash a_crash() {
  wire::Crash c;
  c.cause = wire::CrashCause::kStackOverflow;
  c.lr = 0x08005679;
  c.uptime_ms = 3200;
  c.number = 1;
  return c;
}

// A crash is also named after power was lost since; it is reported once, and again when it happens again.
TEST(Verify, names_a_controller_that_crashed) {
  Fixture fixture(6);
  fixture.flash();
  ASSERT_TRUE(fixture.verify(false).findings.empty());
  for (int again = 0; again < 2; ++again) {
    fixture.skin().crash(0, a_crash());
    if (again == 1) {
      fixture.bus().listen(fixture.bus().now_us() + 100'000);
      fixture.skin().power_cycle(0);
    }
    const VerifyResult r = fixture.verify(false);
    expect_one(r, FindingKind::kCrashedController, -1);
    EXPECT_EQ(r.findings[0].patch, 0);
    EXPECT_NE(
        r.findings[0].text.find("controller 1 was stopped by a stack overflow after 3.2 s in what was called from "
                                "08005676"),
        std::string::npos)
        << r.findings[0].text;
    EXPECT_EQ(r.modules_ok, 6) << "its modules work";
    EXPECT_TRUE(fixture.verify(false).findings.empty()) << "told once";
  }
}

TEST(Verify, names_a_removed_chip) {
  for (const int module : {0, 3, 5}) {
    const VerifyResult r = verify_with({fault(FaultKind::kRemovedChip, module)});
    expect_one(r, FindingKind::kAbsentModule, module);
    EXPECT_EQ(r.modules_ok, 5);
  }
}

TEST(Verify, names_a_removed_chip_without_touching) {
  expect_one(verify_with({fault(FaultKind::kRemovedChip, 4)}, 6, 16, false), FindingKind::kAbsentModule, 4);
}

TEST(Verify, names_swapped_modules_in_one_patch_and_across_patches) {
  expect_one(verify_with({fault(FaultKind::kSwappedChips, 1, 4)}), FindingKind::kSwappedModules, 1, 4);
  expect_one(verify_with({fault(FaultKind::kSwappedChips, 2, 9)}, 12, 6), FindingKind::kSwappedModules, 2, 9);
}

TEST(Verify, names_a_module_at_a_wrong_free_place) {
  hardware::Fault moved = fault(FaultKind::kMovedChip, 5);
  moved.line = 3;
  moved.address = 1;
  const VerifyResult r = verify_with({moved});
  expect_one(r, FindingKind::kWrongAddress, 5);
  EXPECT_EQ(r.findings[0].line, 3);
  EXPECT_EQ(r.findings[0].address, 1);
}

TEST(Verify, names_two_modules_at_one_address) {
  hardware::Fault moved = fault(FaultKind::kMovedChip, 5);  // The chip moves onto module 2: line 0, address 2.
  moved.line = 0;
  moved.address = 2;
  const VerifyResult r = verify_with({moved});
  expect_one(r, FindingKind::kDuplicateAddress, 5, 2);
  EXPECT_EQ(r.modules_ok, 4);
}

TEST(Verify, names_a_finger_on_another_module) {
  expect_one(verify_with({fault(FaultKind::kFingerElsewhere, 0, 3)}), FindingKind::kTouchedOtherModule, 0, 3);
  expect_one(verify_with({fault(FaultKind::kFingerElsewhere, 1, 10)}, 12, 6), FindingKind::kTouchedOtherModule, 1, 10);
}

TEST(Verify, names_a_stuck_line_and_counts_its_modules) {
  for (const bool scl : {false, true}) {
    hardware::Fault stuck;
    stuck.kind = FaultKind::kStuckLine;
    stuck.patch = layout::PatchIndex{0};
    stuck.line = 1;
    stuck.stuck_scl = scl;
    const VerifyResult r = verify_with({stuck});  // The line has modules 4 and 5.
    expect_one(r, FindingKind::kStuckLine, -1);
    EXPECT_EQ(r.findings[0].line, 1);
    EXPECT_EQ(r.modules_ok, 4);
  }
}

TEST(Verify, names_a_line_that_was_freed_by_clock_pulses) {
  hardware::Fault stuck;
  stuck.kind = FaultKind::kStuckLine;
  stuck.patch = layout::PatchIndex{0};
  stuck.line = 0;
  stuck.from_us = 1'000'000;
  stuck.frees_after_pulses = 5;
  const VerifyResult r = verify_with({stuck});
  ASSERT_FALSE(r.findings.empty());
  EXPECT_EQ(r.findings[0].kind, FindingKind::kStuckLine);
  EXPECT_NE(r.findings[0].text.find("freed"), std::string::npos) << r.findings[0].text;
}

TEST(Verify, names_a_foreign_chip) {
  hardware::Fault f = fault(FaultKind::kWrongId, 2);
  f.value = 0x1234;
  expect_one(verify_with({f}), FindingKind::kWrongId, 2);
}

TEST(Verify, names_a_chip_that_lost_its_configuration) {
  hardware::Fault f = fault(FaultKind::kLostConfiguration, 3);
  f.from_us = 900'000;
  expect_one(verify_with({f}), FindingKind::kLostConfiguration, 3);
}

TEST(Verify, what_is_remembered_from_before_is_told_once_and_no_finding) {
  hardware::Fault f = fault(FaultKind::kLostConfiguration, 3);
  f.from_us = 900'000;
  Fixture fixture(6, 16, {f});
  fixture.flash();
  fixture.bus().listen(3'000'000);
  VerifyResult r = fixture.verify();
  EXPECT_TRUE(r.findings.empty());
  EXPECT_EQ(r.modules_ok, 6);
  ASSERT_EQ(r.earlier.size(), 1U);
  EXPECT_EQ(r.earlier[0].kind, FindingKind::kLostConfiguration);
  EXPECT_EQ(r.earlier[0].module, 3);
  EXPECT_TRUE(fixture.verify().earlier.empty());
}

TEST(Verify, names_saturated_and_frozen_taxels) {
  hardware::Fault f = fault(FaultKind::kSaturatedTaxel, 1);
  f.taxel = layout::TaxelIndex{7};
  VerifyResult r = verify_with({f});
  expect_one(r, FindingKind::kSaturatedTaxel, 1);
  EXPECT_EQ(r.findings[0].taxel, 7);
  f.kind = FaultKind::kFrozenTaxel;
  f.taxel = layout::TaxelIndex{11};
  r = verify_with({f});
  expect_one(r, FindingKind::kFrozenTaxel, 1);
  EXPECT_EQ(r.findings[0].taxel, 11);
}

TEST(Verify, tells_several_faults_apart) {
  hardware::Fault saturated = fault(FaultKind::kSaturatedTaxel, 1);
  saturated.taxel = layout::TaxelIndex{0};
  const VerifyResult r =
      verify_with({fault(FaultKind::kRemovedChip, 0), saturated, fault(FaultKind::kSwappedChips, 2, 4)});
  ASSERT_EQ(r.findings.size(), 3U);
  EXPECT_EQ(r.findings[0].kind, FindingKind::kSwappedModules);  // A wrong map is likelier than dead hardware.
  EXPECT_EQ(r.findings[1].kind, FindingKind::kAbsentModule);
  EXPECT_EQ(r.findings[2].kind, FindingKind::kSaturatedTaxel);
  EXPECT_EQ(r.modules_ok, 2);
}

}  // namespace
}  // namespace triskin::diagnose
