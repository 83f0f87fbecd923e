// SPDX-License-Identifier: GPL-3.0-or-later
// A small campaign; triskin-bench converters runs the large one.
#include "sim/hardware/converter_campaign.hpp"

#include <gtest/gtest.h>

namespace triskin::test {
namespace {

TEST(ConverterCampaign, EveryHealthyModuleStreamsAndEveryFaultIsFound) {
  constexpr int kPatches = 12;
  constexpr std::uint32_t kFirstSeed = 20261128;
  for (const auto& [fault, c] : run_campaign(kPatches, kFirstSeed)) {
    SCOPED_TRACE(kPatchFaultNames[static_cast<std::size_t>(fault)]);
    EXPECT_EQ(c.patches, kPatches);
    EXPECT_GE(c.healthy, kPatches * 12);
    EXPECT_GE(c.faulty, fault == PatchFault::kNone ? 0 : kPatches);
    for (const std::string& d : c.descriptions) ADD_FAILURE() << d;
  }
}

}  // namespace
}  // namespace triskin::test
