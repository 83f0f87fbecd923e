// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/diagnose/verify_report.hpp"

#include <gtest/gtest.h>

#include "support/device_fixture.hpp"

namespace triskin::diagnose {

using test::fault;
using test::Fixture;

namespace {

using hardware::FaultKind;

VerifyResult with(std::vector<hardware::Fault> faults) {
  Fixture fixture(13, 16, std::move(faults));
  fixture.flash();
  return fixture.verify();
}

TEST(VerifyReport, says_what_where_and_what_to_do) {
  const VerifyResult r = with({fault(FaultKind::kRemovedChip, 12), fault(FaultKind::kSwappedChips, 0, 4)});
  ASSERT_EQ(r.findings.size(), 2U);
  EXPECT_EQ(r.findings[0].place, "island 0, row 1 of 1, left rim");
  EXPECT_EQ(r.findings[1].place, "island 0, row 1 of 1, right rim");
  const std::string text = report_text(test::strip(13), r);
  for (const char* part :
       {"1. swapped_modules: ", "2. absent_module: ", "on the cover: island 0, row 1 of 1, right rim",
        "exchange their straps", "10 of 13 modules ok"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
}

TEST(VerifyReport, the_page_marks_the_modules_of_the_findings) {
  const VerifyResult r = with({fault(FaultKind::kSwappedChips, 1, 4)});
  design::Design d = test::strip(13);
  d.name = "left <arm>";
  const std::string html = report_html(d, r);
  std::size_t bad = 0, all = 0;
  for (std::size_t at = html.find("<polygon "); at != std::string::npos; at = html.find("<polygon ", at + 1)) ++all;
  for (std::size_t at = html.find("class=\"bad\""); at != std::string::npos; at = html.find("class=\"bad\"", at + 1))
    ++bad;
  EXPECT_EQ(all, 13U);
  EXPECT_EQ(bad, 2U);
  EXPECT_NE(html.find("left &lt;arm&gt;"), std::string::npos);
  EXPECT_EQ(html.find("<arm>"), std::string::npos);
  EXPECT_NE(html.find("swapped_modules"), std::string::npos);
}

TEST(VerifyReport, a_place_that_is_neither_end_is_counted_from_the_left) {
  const VerifyResult r = with({fault(FaultKind::kRemovedChip, 3)});
  ASSERT_FALSE(r.findings.empty());
  EXPECT_EQ(r.findings[0].place, "island 0, row 1 of 1, 4 of 13 from the left");
}

}  // namespace
}  // namespace triskin::diagnose
