// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the kinds of modules in tables, and the findings of verify about them.
#include <set>

#include "support/device_fixture.hpp"
#include "triskin/base/error.hpp"
#include "triskin/session/patch_table.hpp"
#include "triskin/session/stream.hpp"

namespace triskin::deploy {

using test::Fixture;
using test::taking_over;

namespace {

design::Design with_kinds(design::Design d, const std::vector<int>& numbers) {
  d.kinds.kinds = {{"soft", 12, "foam", 80.0}, {"hard", 12, "rubber", 20.0}};
  for (std::size_t k = 0; k < numbers.size(); ++k) d.layout.modules[k].kind = numbers[k];
  d.design_id = design::design_id_of(d);
  return d;
}

diagnose::VerifyResult verified(Fixture& fixture, const design::Design& d, bool touch = false) {
  diagnose::VerifyOptions options;
  options.touch = touch;
  options.actuator = link::touch_actuator_of(fixture.bus().link());
  return verify(fixture.bus(), d, options);
}

TEST(KindsInTables, are_the_high_bits_of_module_ids) {
  const design::Design d = with_kinds(test::strip(6), {0, 1, 2, 0, 0, 2});
  const layout::PatchImage image = session::image_of(d, layout::PatchIndex{0}),
                           plain = session::image_of(test::strip(6), layout::PatchIndex{0});
  // The ids are 1 · 8192 + 1 and 2 · 8192 + 2.
  EXPECT_EQ(image.modules[1].module_id, 8193);
  EXPECT_EQ(image.modules[2].module_id, 16386);
  EXPECT_EQ(image.modules[3].module_id, 3);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(session::module_of(d, image.modules[k]), static_cast<int>(k));
    EXPECT_EQ(session::kind_of_row(d, image.modules[k]), d.layout.modules[k].kind);
    EXPECT_EQ(plain.modules[k].module_id, k);
  }
  // A design without kinds may have ids beyond 8191, but one with kinds may not.
  design::Design large = test::strip(8193);
  EXPECT_EQ(session::module_of(large, {.module_id = 8192}), 8192);
  large.patches.resize(1);
  EXPECT_NO_THROW((void)session::image_of(large, layout::PatchIndex{0}));
  EXPECT_THROW((void)session::image_of(with_kinds(large, {1}), layout::PatchIndex{0}), InputError);
}

TEST(KindsInTables, are_flashed_verified_and_read) {
  Fixture fixture(8, 4);
  const design::Design d = with_kinds(fixture.design(), {0, 1, 1, 0, 2, 0, 0, 1});
  (void)flash(fixture.bus(), d, taking_over());
  const diagnose::VerifyResult r = verified(fixture, d, true);
  EXPECT_TRUE(r.findings.empty()) << r.findings[0].text;
  EXPECT_EQ(r.modules_ok, 8);
  EXPECT_EQ(r.touched, 8);
  std::set<int> heard;
  session::Stream stream(fixture.bus(), d, [&](const session::ModuleSample& f) { heard.insert(f.module); });
  stream.run_until(fixture.bus().now_us() + 300'000);
  stream.finish();
  EXPECT_EQ(heard, (std::set{0, 1, 2, 3, 4, 5, 6, 7}));
}

TEST(KindsInTables, another_kind_is_a_finding_of_its_module) {
  Fixture fixture(8, 4);
  (void)flash(fixture.bus(), with_kinds(fixture.design(), {0, 1, 1, 0, 2, 0, 0, 1}), taking_over());
  const diagnose::VerifyResult r = verified(fixture, with_kinds(fixture.design(), {0, 1, 2, 1, 2, 0, 0, 1}));
  ASSERT_EQ(r.findings.size(), 3U);
  EXPECT_EQ(r.findings[0].kind, diagnose::FindingKind::kWrongKind);
  EXPECT_EQ(r.findings[0].module, 2);
  EXPECT_EQ(r.findings[0].text,
            "patch 0: module 2 is of kind 1 (soft) in the table of controller 1, of kind 2 (hard) in the design");
  EXPECT_EQ(r.findings[1].module, 3);
  EXPECT_EQ(r.findings[1].text,
            "patch 0: module 3 is of the standard kind in the table of controller 1, of kind 1 (soft) in the design");
  // Patch 1 has the right kinds, but its table still belongs to the other design.
  EXPECT_EQ(r.findings[2].kind, diagnose::FindingKind::kWrongTable);
  EXPECT_EQ(r.findings[2].patch, 1);
}

TEST(KindsInTables, a_design_that_lost_its_kinds_is_told_apart) {
  Fixture fixture(4);
  (void)flash(fixture.bus(), with_kinds(fixture.design(), {0, 0, 2, 0}), taking_over());
  const diagnose::VerifyResult r = verified(fixture, fixture.design());
  ASSERT_EQ(r.findings.size(), 1U);
  EXPECT_EQ(r.findings[0].kind, diagnose::FindingKind::kWrongKind);
  EXPECT_EQ(r.findings[0].text,
            "patch 0: module 2 is of kind 2 in the table of controller 1, of the standard kind in the design");
}

}  // namespace
}  // namespace triskin::deploy
