// SPDX-License-Identifier: GPL-3.0-or-later
// Tests reports of a stream of several covers, which number their modules and patches alike.
#include "triskin/session/stream_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace triskin::session {
namespace {

using layout::CoverIndex;
using layout::ModuleId;
using layout::PatchIndex;
using testing::ElementsAre;

constexpr session::SampleCounts kWhole{.expected = 100, .received = 100, .with_data = 100};
constexpr session::SampleCounts kEmpty{.expected = 100, .received = 100, .with_data = 0};

session::ModuleCounts module_of(CoverIndex cover, PatchIndex patch, ModuleId module,
                                const session::SampleCounts& counts) {
  return {module, patch, counts, false, cover, design::ModuleNumber{module}};
}

// Modules 3 of two covers are silent, and a neighbour reads that of cover 0. The report used to call neither silent.
TEST(StreamReport, a_module_that_a_neighbour_reads_hides_no_silent_module_of_another_cover) {
  session::StreamReport report;
  for (const CoverIndex cover : {CoverIndex{0}, CoverIndex{1}})
    report.modules.push_back(module_of(cover, PatchIndex{0}, ModuleId{3}, kEmpty));
  report.adopted.push_back({ModuleId{3}, PatchIndex{1}, kWhole, true, CoverIndex{0}});
  session::sum_up(report, 0);
  EXPECT_THAT(report.never_heard, ElementsAre(3));
}

TEST(StreamReport, a_module_that_a_neighbour_reads_counts_as_heard) {
  session::StreamReport report;
  report.modules.push_back(module_of(CoverIndex{0}, PatchIndex{0}, ModuleId{3}, kEmpty));
  report.adopted.push_back({ModuleId{3}, PatchIndex{1}, kWhole, true, CoverIndex{0}});
  session::sum_up(report, 0);
  EXPECT_TRUE(report.never_heard.empty());
}

// Patch 0 of cover 0 loses 2 of 100 samples for want of room. Taken together with patch 0 of cover 1, as it was, it
// would lose 1 % of 200, which is not more than 1 %.
TEST(StreamReport, a_patch_that_finds_no_room_is_named_whatever_those_of_other_covers_do) {
  session::StreamReport report;
  report.modules.push_back(module_of(CoverIndex{0}, PatchIndex{0}, ModuleId{0},
                                     {.expected = 100, .received = 98, .with_data = 98, .dropped = 2}));
  report.modules.push_back(module_of(CoverIndex{1}, PatchIndex{0}, ModuleId{0}, kWhole));
  session::sum_up(report, 0);
  EXPECT_THAT(report.starved, ElementsAre(0));
}

}  // namespace
}  // namespace triskin::session
