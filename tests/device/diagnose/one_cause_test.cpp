// SPDX-License-Identifier: GPL-3.0-or-later
// One cause must give one finding, however many modules or patches it concerns.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "support/device_fixture.hpp"
#include "triskin/diagnose/design_files.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_table.hpp"

namespace triskin::diagnose {

using test::fault;
using test::Fixture;

namespace {

using hardware::FaultKind;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAre;

design::Design other_strip(int modules, int per_patch) {
  design::Design other = test::strip(modules, per_patch);
  for (design::Patch& p : other.patches) std::swap(p.modules[1].address, p.modules[2].address);
  other.name = "other";
  other.design_id = design::design_id_of(other);
  return other;
}

// Returns what every taxel reads now, once the converters have settled.
design::RestValues rest_now(Fixture& fixture) {
  fixture.bus().listen(fixture.bus().now_us() + 3'000'000);
  design::RestValues rest(fixture.design().layout.modules.size());
  for (const layout::PatchIndex patch : design::patches_here(fixture.design())) {
    const layout::PatchImage image = session::image_of(fixture.design(), patch);
    const wire::LiveTaxels now = session::Controller(fixture.bus(), image.node_address).taxels();
    for (std::size_t row = 0; row < image.module_count; ++row)
      std::ranges::copy(now.modules[row].value, rest.at(image.modules[row].module_id).begin());
  }
  return rest;
}

TEST(OneCause, controllers_that_were_never_flashed_are_one_finding) {
  Fixture fixture(12, 6);
  const VerifyResult r = fixture.verify();
  ASSERT_EQ(r.findings.size(), 1U);
  EXPECT_EQ(r.findings[0].kind, FindingKind::kNotFlashed);
  EXPECT_THAT(r.findings[0].text, AllOf(HasSubstr("patches 0, 1"), HasSubstr("2 of 2")));
  EXPECT_THAT(r.findings[0].place, HasSubstr("cable of patch 0 at module 0, island 0, row 1 of 1"));
}

TEST(OneCause, two_boards_on_one_address_are_that_and_the_patch_without_one_is_named) {
  Fixture fixture(12, 6);
  fixture.flash();
  const auto claims = fixture.bus().discover();
  ASSERT_EQ(claims.size(), 2U);
  const auto& second = claims[0].node_address == 2 ? claims[0] : claims[1];
  fixture.bus().assign(second.unique_id, 1);
  fixture.bus().listen(fixture.bus().now_us() + 500'000);
  const VerifyResult r = fixture.verify();
  ASSERT_EQ(r.findings.size(), 1U);
  EXPECT_EQ(r.findings[0].kind, FindingKind::kDuplicateController);
  EXPECT_EQ(r.findings[0].patch, 0);
  EXPECT_THAT(r.findings[0].text, AllOf(HasSubstr("share node address 1"), HasSubstr("patch 1 has none"),
                                        HasSubstr(session::to_text(claims[0].unique_id)),
                                        HasSubstr(session::to_text(claims[1].unique_id))));
}

TEST(OneCause, a_wrong_design_file_is_thought_of_before_flashing) {
  Fixture fixture(12, 6);
  fixture.flash();
  const design::Design other = other_strip(12, 6);
  VerifyResult r = verify(fixture.bus(), other, {});
  ASSERT_EQ(r.findings.size(), 1U);
  EXPECT_EQ(r.findings[0].kind, FindingKind::kWrongTable);
  EXPECT_EQ(r.findings[0].held_design, fixture.design().design_id);
  EXPECT_THAT(r.findings[0].text, HasSubstr("patches 0, 1"));
  EXPECT_LT(r.findings[0].remedy.find("right file"), r.findings[0].remedy.find("triskin flash"));
  const auto folder = std::filesystem::path(testing::TempDir()) / "one_cause";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  design::write_design(folder / "held.json", fixture.design());
  design::write_design(folder / "mine.json", other);
  name_files(r.findings, folder / "mine.json");
  EXPECT_EQ(r.findings[0].held_file, (folder / "held.json").string());
  EXPECT_THAT(files_of_design(folder, other.design_id), ElementsAre(folder / "mine.json"));
  EXPECT_THAT(files_of_design(folder, 1), IsEmpty());
  EXPECT_THAT(files_of_design(folder / "absent", 1), IsEmpty());
}

// The strip is a chain, so 5, 6 and 7 lie behind the joint of 4 and 5.
VerifyResult verify_switched(std::vector<hardware::Fault> faults, const design::Design& of = test::strip(8, 8)) {
  hardware::Scene scene;
  scene.design = of;
  scene.switched = true;
  scene.faults = std::move(faults);
  const design::Design design = scene.design;
  hardware::SimLink link(std::move(scene));
  session::Bus bus(link);
  deploy::flash(bus, design);
  return verify(bus, design, {});
}

TEST(OneCause, an_open_joint_of_switched_modules_is_one_broken_joint) {
  const VerifyResult r = verify_switched({fault(FaultKind::kOpenJoint, 4, 5)});
  ASSERT_EQ(r.findings.size(), 1U);
  const Finding& f = r.findings[0];
  EXPECT_EQ(f.kind, FindingKind::kMissingJoint);
  EXPECT_THAT((std::array{f.module, f.other}), UnorderedElementsAre(4, 5));
  EXPECT_THAT(f.behind, ElementsAre(6, 7));
  EXPECT_THAT(f.text, AllOf(HasSubstr("module 4 (side "), HasSubstr("module 5 (side "), HasSubstr("5, 6, 7")));
  EXPECT_EQ(r.modules_ok, 5);
}

// Patch 1 has four modules in a chain. What a break leaves of patch 0 looks just like it, but its own controller reads
// it.
TEST(OneCause, a_break_that_leaves_the_shape_of_another_patch_is_a_broken_joint) {
  const design::Design design = test::strip(12, 8);
  ASSERT_EQ(design.patches[1].modules.size(), 4U);
  const VerifyResult r = verify_switched({fault(FaultKind::kOpenJoint, 3, 4)}, design);
  ASSERT_EQ(r.findings.size(), 1U);
  EXPECT_EQ(r.findings[0].kind, FindingKind::kMissingJoint);
  EXPECT_THAT((std::array{r.findings[0].module, r.findings[0].other}), UnorderedElementsAre(3, 4));
  EXPECT_THAT(r.findings[0].behind, ElementsAre(5, 6, 7));
}

// One module is no proof of another patch, either: seven are out of reach.
TEST(OneCause, a_break_behind_the_entry_is_a_broken_joint) {
  const VerifyResult r = verify_switched({fault(FaultKind::kOpenJoint, 0, 1)});
  ASSERT_EQ(r.findings.size(), 1U);
  EXPECT_EQ(r.findings[0].kind, FindingKind::kMissingJoint);
  EXPECT_THAT((std::array{r.findings[0].module, r.findings[0].other}), UnorderedElementsAre(0, 1));
}

// The table opens the port of module 3 at which module 4 should be.
TEST(OneCause, a_turned_module_explains_those_that_are_read_through_it) {
  hardware::Fault turned = fault(FaultKind::kRotatedModule, 3);
  turned.value = 1;
  const VerifyResult r = verify_switched({turned});
  ASSERT_EQ(r.findings.size(), 1U);
  EXPECT_EQ(r.findings[0].kind, FindingKind::kRotatedModule);
  EXPECT_EQ(r.findings[0].module, 3);
  EXPECT_THAT(r.findings[0].behind, ElementsAre(4, 5, 6, 7));
  EXPECT_THAT(r.findings[0].text, HasSubstr("with this table 4 modules cannot be read: 4, 5, 6, 7"));
  EXPECT_EQ(r.modules_ok, 3);
}

// Nothing is left to ask what kind the modules are.
TEST(OneCause, a_dead_entry_of_switched_modules_is_thought_of_beside_the_cable) {
  const VerifyResult r = verify_switched({fault(FaultKind::kDeadModule, 0)});
  ASSERT_EQ(r.findings.size(), 1U);
  EXPECT_THAT(r.findings[0].text, HasSubstr("the cable of the patch"));
  EXPECT_THAT(r.findings[0].remedy, HasSubstr("of switched modules, module 0, where the cable enters, may be dead"));
}

// Nothing can be left out at the entry. The controller looks for a way round again and again, so that the other lines
// have gaps, too.
TEST(OneCause, a_line_held_at_the_entry_of_switched_modules_is_one_finding) {
  hardware::Fault held = fault(FaultKind::kHeldLine, 0);
  held.line = 1;
  const VerifyResult r = verify_switched({held});
  ASSERT_EQ(r.findings.size(), 1U);
  EXPECT_EQ(r.findings[0].kind, FindingKind::kStuckLine);
  EXPECT_EQ(r.findings[0].line, 1);
  EXPECT_THAT(r.findings[0].text, HasSubstr("at the cable or at module 0"));
}

TEST(OneCause, an_open_joint_of_strapped_modules_is_one_broken_joint) {
  Fixture fixture(
      8, 8, {fault(FaultKind::kRemovedChip, 5), fault(FaultKind::kRemovedChip, 6), fault(FaultKind::kRemovedChip, 7)});
  fixture.flash();
  const VerifyResult r = fixture.verify();
  ASSERT_EQ(r.findings.size(), 1U);
  EXPECT_EQ(r.findings[0].kind, FindingKind::kMissingJoint);
  EXPECT_THAT(r.findings[0].text, AllOf(HasSubstr("module 4 (side "), HasSubstr("module 5 (side ")));
}

TEST(OneCause, taxels_that_rest_elsewhere_are_counted_and_a_tare_ends_it) {
  Fixture fixture(6);
  fixture.flash();
  VerifyOptions options;
  options.rest = rest_now(fixture);
  ASSERT_EQ(options.rest.size(), 6U);
  EXPECT_THAT(verify(fixture.bus(), fixture.design(), options).findings, IsEmpty());
  // The file is stale: the pressure taxels of module 2 have moved, those of module 4 by less than a touch.
  // Converters differ from what they read before by up to 6 counts of noise and 4 of slow noise (docs/silicon.md).
  constexpr double kNoise_counts = 10.0;
  for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) {
    if (!layout::measures_pressure(t)) continue;
    options.rest[2][t] += kMaxRestError_counts + kNoise_counts;
    options.rest[4][t] -= kMaxRestError_counts - kNoise_counts;
  }
  const VerifyResult r = verify(fixture.bus(), fixture.design(), options);
  ASSERT_EQ(r.findings.size(), 1U);
  EXPECT_EQ(r.findings[0].kind, FindingKind::kStaleRest);
  EXPECT_EQ(r.findings[0].module, 2);
  EXPECT_THAT(r.findings[0].text, HasSubstr("10 taxels do not rest: tare"));
  EXPECT_EQ(r.modules_ok, 6) << "nothing is wrong with the modules";
  options.rest = rest_now(fixture);
  EXPECT_THAT(verify(fixture.bus(), fixture.design(), options).findings, IsEmpty());
}

// Warming moves all pads of a module alike, so it is no stale rest value.
TEST(OneCause, what_all_pads_of_a_module_share_is_warming) {
  Fixture fixture(6);
  fixture.flash();
  VerifyOptions options;
  options.rest = rest_now(fixture);
  for (double& counts : options.rest[3]) counts += 900;
  EXPECT_THAT(verify(fixture.bus(), fixture.design(), options).findings, IsEmpty());
}

}  // namespace
}  // namespace triskin::diagnose
