// SPDX-License-Identifier: GPL-3.0-or-later
// Ninety draws of what `triskin-bench causes` draws a thousand times (docs/measurements/device.md).
#include "device/diagnose/causes.hpp"

#include <gtest/gtest.h>

#include <cctype>

#include "triskin/base/error.hpp"

namespace triskin::test {
namespace {

class Causes : public testing::TestWithParam<Cause> {};

TEST_P(Causes, are_one_finding_with_their_place) {
  const CauseScore score = score_of(GetParam(), 0, 5);
  EXPECT_EQ(score.of(CauseDraw::Verdict::kRight) + score.of(CauseDraw::Verdict::kBoth), score.draws);
  for (const std::string& said : score.not_right) ADD_FAILURE() << said;
}

INSTANTIATE_TEST_SUITE_P(All, Causes,
                         testing::Values(Cause::kNone, Cause::kSupplyDrop, Cause::kBrokenTrace, Cause::kLineHeld,
                                         Cause::kOtherFirmware, Cause::kWrongAddress, Cause::kBrokenStrap,
                                         Cause::kSameNumber, Cause::kDriftingChip, Cause::kStuckTaxel,
                                         Cause::kLoosePlug, Cause::kDeadModule, Cause::kOpenJoint, Cause::kShortedJoint,
                                         Cause::kModuleHoldsLine, Cause::kTurnedModule, Cause::kExchangedModules,
                                         Cause::kModuleReset),
                         [](const auto& tested) {
                           std::string name = kCauseNames[static_cast<std::size_t>(tested.param)];
                           std::ranges::replace_if(name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
                           return name;
                         });

}  // namespace
}  // namespace triskin::test
