// SPDX-License-Identifier: GPL-3.0-or-later
#include "rules.hpp"

#include <gmock/gmock.h>

#include <set>
#include <string>

namespace triskin::diagnose {
namespace {

using testing::HasSubstr;

// Every kind that reports can name has a rule, and no two rules say the same.
TEST(Rules, cover_every_kind_of_finding) {
  std::set<FindingKind> causes;
  std::set<std::string> said;
  for (const Rule& rule : rules()) {
    causes.insert(rule.cause);
    EXPECT_TRUE(said.insert(std::string(rule.said) + rule.remedy).second) << rule.said;
  }
  for (const auto& [kind, name] : kFindingKindNames.rows()) EXPECT_TRUE(causes.contains(kind)) << name;
}

TEST(Rules, fill_in_the_words_of_what_was_seen) {
  const Finding f = finding(Seen::kOtherPlace, fmt::arg("where", "module 3 (patch 0, L1)"), fmt::arg("module", 3),
                            fmt::arg("place", "L2"), fmt::arg("meant", "L1"));
  EXPECT_EQ(f.kind, FindingKind::kWrongAddress);
  EXPECT_EQ(f.text,
            "module 3 (patch 0, L1): nothing answers there, but a chip answers at L2, where the design has none");
  EXPECT_EQ(f.remedy, "solder the straps of module 3 to L1");
  EXPECT_THROW((void)finding(Seen::kOtherPlace, fmt::arg("module", 3)), fmt::format_error);
}

// Worked by hand from the rule that one cause for many modules comes before a cause for one, and hardware after maps.
TEST(Rules, order_causes_by_likelihood) {
  EXPECT_LT(likelihood_rank(FindingKind::kWrongPatch), likelihood_rank(FindingKind::kMissingJoint));
  EXPECT_LT(likelihood_rank(FindingKind::kMissingJoint), likelihood_rank(FindingKind::kAbsentModule));
  EXPECT_LT(likelihood_rank(FindingKind::kWrongAddress), likelihood_rank(FindingKind::kAbsentModule));
  EXPECT_LT(likelihood_rank(FindingKind::kFrozenTaxel), likelihood_rank(FindingKind::kStaleRest));
  EXPECT_EQ(likelihood_rank(FindingKind::kMissingModule), likelihood_rank(FindingKind::kSecondCable));
  EXPECT_EQ(work_of(FindingKind::kStuckLine), Work::kShort);
  EXPECT_EQ(work_of(FindingKind::kStaleRest), Work::kTare);
}

}  // namespace
}  // namespace triskin::diagnose
