// SPDX-License-Identifier: GPL-3.0-or-later
// Tests how a host sees the converters' offsets, with the electrodes at either input.
#include "support/device_fixture.hpp"
#include "triskin/diagnose/offset_report.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/stream.hpp"

namespace triskin::diagnose {

using test::fault;
using test::Fixture;

namespace {

class Offsets : public testing::TestWithParam<bool> {};

TEST_P(Offsets, EveryTaxelRestsInTheMiddleThirdAndPressureLowersIt) {
  Fixture f(20);  // The strip has two patches.
  deploy::FlashOptions options;
  options.positive_input = GetParam();
  (void)f.flash(options);
  f.bus().listen(f.bus().now_us() + 1'000'000);
  EXPECT_TRUE(f.verify(false).findings.empty());
  const auto patches = session::read_offsets(f.bus(), f.design());
  ASSERT_EQ(patches.size(), 2U);
  EXPECT_EQ(patches[0].offsets.count, 16);
  EXPECT_EQ(patches[1].modules.size(), 4U);
  for (const session::PatchOffsets& p : patches) {
    EXPECT_EQ(p.offsets.positive_input, GetParam());
    for (const wire::ModuleOffsets& m : p.offsets.rows()) {
      EXPECT_EQ(m.state, wire::OffsetState::kFound);
      EXPECT_NE(m.latching, wire::Latching::kUnknown);
      EXPECT_EQ(m.outside, 0);
    }
    EXPECT_EQ(describe(f.design(), p).size(), 1U);
    EXPECT_NE(describe(f.design(), p)[0].find(GetParam() ? "positive" : "negative"), std::string::npos);
  }
  std::vector<session::ModuleSample> frames;
  session::Stream stream(f.bus(), f.design(), [&](const session::ModuleSample& frame) { frames.push_back(frame); });
  stream.run_until(f.bus().now_us() + 100'000);
  ASSERT_FALSE(frames.empty());
  int at_rest = 0;
  for (const session::ModuleSample& frame : frames) {
    for (const std::uint16_t v : frame.sample.value) {
      EXPECT_GE(v, wire::kRestLeast);
      EXPECT_LE(v, wire::kRestMost);
    }
    if (frame.module == 7) at_rest = frame.sample.value[3];
  }
  link::touch_actuator_of(f.bus().link())->press(layout::ModuleId{7});
  frames.clear();
  stream.run_until(f.bus().now_us() + 200'000);
  int pressed = 0;
  for (const session::ModuleSample& frame : frames) pressed = frame.module == 7 ? frame.sample.value[3] : pressed;
  EXPECT_LT(pressed, at_rest - 200);
}
INSTANTIATE_TEST_SUITE_P(Inputs, Offsets, testing::Bool(),
                         [](const auto& tested) { return std::string(tested.param ? "positive" : "negative"); });

TEST(OffsetReport, NamesTheTaxelThatNoOffsetReaches) {
  hardware::Fault shorted = fault(hardware::FaultKind::kSaturatedTaxel, 2);
  shorted.taxel = layout::TaxelIndex{9};
  Fixture f(3, 16, {shorted});
  (void)f.flash();
  f.bus().listen(f.bus().now_us() + 1'500'000);
  const auto patches = session::read_offsets(f.bus(), f.design());
  ASSERT_EQ(patches.size(), 1U);
  EXPECT_EQ(patches[0].offsets.modules[2].state, wire::OffsetState::kOutside);
  EXPECT_EQ(patches[0].offsets.modules[2].outside, 1U << 9);
  ASSERT_EQ(describe(f.design(), patches[0]).size(), 2U);
  EXPECT_NE(describe(f.design(), patches[0])[1].find("module 2: no offset brings taxel 9"), std::string::npos)
      << describe(f.design(), patches[0])[1];
}

// Taxel 3 rests 9,300 counts above the end of its range at the last offset, taxel 9 at the end of its range.
TEST(OffsetReport, TellsRestingOffTheMiddleFromAnEndOfTheRange) {
  session::PatchOffsets p{layout::PatchIndex{0}, {layout::ModuleId{4}}, {}, {}, {}};
  p.offsets.count = p.rest.count = 1;
  p.offsets.modules[0].state = wire::OffsetState::kOutside;
  p.offsets.modules[0].outside = 1U << 3 | 1U << 9;
  p.offsets.modules[0].steps[3] = wire::kMaxOffset;
  p.rest.modules[0].fill(32'768);
  p.rest.modules[0][3] = 9'300;
  p.rest.modules[0][9] = 0xFFFF;
  const std::vector<std::string> lines = describe(test::strip(5), p);
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[1], "module 4: no offset brings taxel 9 (offset 0.00 pF) into its range: electrode shorted or open");
  EXPECT_NE(lines[2].find("taxel 3 (9300 counts of range left for pressure, offset 20.16 pF); not pressed"),
            std::string::npos)
      << lines[2];
}

TEST(OffsetReport, SearchesAnewOnRequest) {
  Fixture f(3);
  (void)f.flash();
  f.bus().listen(f.bus().now_us() + 1'500'000);
  session::Controller c(f.bus(), 1);
  EXPECT_EQ(c.offsets().searches, 3U);
  EXPECT_EQ(c.search_offsets().searches, 6U);
}

}  // namespace
}  // namespace triskin::diagnose
