// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the steps that follow a finding with the strip drawn in support/strip_design.hpp.
#include "triskin/diagnose/repair.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/device_fixture.hpp"

namespace triskin::diagnose {

using test::fault;
using test::Fixture;

namespace {

using hardware::FaultKind;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> steps_after(std::vector<hardware::Fault> faults, FindingKind kind) {
  Fixture fixture(8, 8, std::move(faults));
  fixture.flash();
  const VerifyResult r = fixture.verify();
  const auto found = std::ranges::find(r.findings, kind, &Finding::kind);
  if (found == r.findings.end()) return {"no such finding"};
  return repair_steps(fixture.design(), *found, "d.json --link sim");
}

// Module 5 is a down tile with line 1 and address 1. Its parent 4 lies across its side 2, where port A is; module 6 is
// connected to it across side 0.
TEST(Repair, a_dead_module_is_replaced_joint_by_joint) {
  const auto steps = steps_after({fault(FaultKind::kRemovedChip, 5)}, FindingKind::kAbsentModule);
  ASSERT_EQ(steps.size(), 10U);
  EXPECT_THAT(steps[0], HasSubstr("triskin flash d.json --link sim --save"));
  EXPECT_THAT(steps[1], HasSubstr("supply"));
  EXPECT_THAT(steps[2], AllOf(HasSubstr("module 5 of patch 0"), HasSubstr("island 0, row 1 of 1")));
  EXPECT_THAT(steps[3], AllOf(HasSubstr("side 2 (port A) to side 1 of module 4"),
                              HasSubstr("side 0 (port B) to side 2 of module 6")));
  EXPECT_THAT(steps[4], HasSubstr("solder the new module in"));
  EXPECT_THAT(steps[5], AllOf(HasSubstr("port A at side 2"), HasSubstr("line L1 and ADD0H ADD1L (2D)")));
  EXPECT_THAT(steps[7], HasSubstr("triskin flash d.json --link sim"));
  EXPECT_THAT(steps[8], HasSubstr("triskin live d.json --link sim --tare"));
  EXPECT_THAT(steps[9], HasSubstr("triskin verify d.json --link sim"));
}

// The kind is in the high bits of the id of a table's row.
TEST(Repair, modules_with_kinds_have_the_same_steps) {
  Finding f;
  f.kind = FindingKind::kAbsentModule;
  f.module = layout::ModuleId{5};
  design::Design d = test::strip(8, 8);
  const auto plain = repair_steps(d, f, "d.json");
  d.kinds.kinds = {{"soft", 12, "foam", 80.0}};
  for (const std::size_t k : {4U, 5U}) d.layout.modules[k].kind = 1;
  EXPECT_EQ(repair_steps(d, f, "d.json"), plain);
}

TEST(Repair, exchanged_modules_get_their_own_straps) {
  const auto steps = steps_after({fault(FaultKind::kSwappedChips, 1, 6)}, FindingKind::kSwappedModules);
  EXPECT_THAT(steps, Contains(AllOf(HasSubstr("module 1:"), HasSubstr("line L0 and ADD0H ADD1L (2D)"))));
  EXPECT_THAT(steps, Contains(AllOf(HasSubstr("module 6:"), HasSubstr("line L1 and ADD0L ADD1H (2E)"))));
}

TEST(Repair, a_joint_is_named_by_both_modules) {
  Finding f;
  f.kind = FindingKind::kLooseJoint;
  f.module = layout::ModuleId{3};
  const auto steps = repair_steps(test::strip(8, 8), f, "d.json");
  EXPECT_THAT(steps, Contains(HasSubstr("the joint of module 3 (side 2) and module 2 (side 1)")));
  f.module = layout::ModuleId{0};
  EXPECT_THAT(repair_steps(test::strip(8, 8), f, "d.json"), Contains(HasSubstr("the cable of patch 0")));
}

TEST(Repair, wrong_tables_need_no_hand) {
  Finding f;
  f.kind = FindingKind::kWrongTable;
  f.patch = layout::PatchIndex{0};
  const auto steps = repair_steps(test::strip(8, 8), f, "d.json");
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_EQ(steps[0], "triskin flash d.json");
  EXPECT_THAT(steps[1], HasSubstr("triskin live d.json --tare"));
}

TEST(Repair, another_design_file_is_tried_before_anything_is_written) {
  Finding f;
  f.kind = FindingKind::kWrongTable;
  f.patch = layout::PatchIndex{0};
  f.held_design = 0xABC;
  f.held_file = "arm/e.json";
  const auto steps = repair_steps(test::strip(8, 8), f, "d.json --link can:can0");
  EXPECT_THAT(steps[0], HasSubstr("triskin verify arm/e.json --link can:can0"));
  EXPECT_THAT(steps[1], HasSubstr("triskin flash d.json --link can:can0 --take-over"));
}

TEST(Repair, rest_values_need_a_tare_alone) {
  Finding f;
  f.kind = FindingKind::kStaleRest;
  f.module = layout::ModuleId{3};
  const auto steps = repair_steps(test::strip(8, 8), f, "d.json");
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_THAT(steps[0], HasSubstr("--tare"));
}

// Modules 4 … 7 of a patch of eight are on line 1.
TEST(Repair, a_line_that_is_held_is_parted_from_the_far_end) {
  Finding f;
  f.kind = FindingKind::kStuckLine;
  f.patch = layout::PatchIndex{0};
  f.line = 1;
  EXPECT_THAT(repair_steps(test::strip(8, 8), f, "d.json"),
              Contains(AllOf(HasSubstr("7, 6, 5, 4"), HasSubstr("part"))));
}

TEST(Repair, every_kind_of_finding_has_steps) {
  const int last = static_cast<int>(FindingKind::kAdoptedModule);
  for (int k = 0; k <= last; ++k) {
    Finding f;
    f.kind = static_cast<FindingKind>(k);
    const std::string_view name = kFindingKindNames.name(f.kind);
    ASSERT_FALSE(name.empty()) << k;
    f.module = layout::ModuleId{3};
    f.other = layout::ModuleId{2};
    f.patch = layout::PatchIndex{0};
    f.line = 0;
    f.remedy = "look";
    const auto steps = repair_steps(test::strip(8, 8), f, "d.json");
    ASSERT_GE(steps.size(), 2U) << name;
    EXPECT_THAT(steps.back(), HasSubstr("triskin verify d.json")) << name;
  }
}

}  // namespace
}  // namespace triskin::diagnose
