// SPDX-License-Identifier: GPL-3.0-or-later
// Seeds mistakes, alone and in pairs: the right explanation must come first. This test makes the table in
// docs/measurements/device.md.
#include "device/diagnose/mistakes.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "support/blob_design.hpp"
#include "support/places.hpp"
#include "support/strip_design.hpp"

namespace triskin::test {
namespace {

using diagnose::FindingKind;

constexpr std::uint64_t kVerifyAt_us = 8'000'000;

struct Score {
  int right = 0, all = 0;
  int exact = 0;  // Among right answers, these have as many findings as causes.
  [[nodiscard]] double percent() const { return all == 0 ? 100.0 : 100.0 * right / all; }
  void count(bool is_right) {
    right += is_right ? 1 : 0;
    ++all;
  }
};

/// Makes two kinds of covers, small and large, with one patch and several.
std::vector<design::Design> designs() {
  return {strip(13), blob({16, 11}, 1), blob({16, 16, 7}, 2), blob({12}, 3)};
}

std::string told(const diagnose::VerifyResult& r) {
  std::string text;
  for (const auto& f : r.findings) text += fmt::format("{}: {}\n", diagnose::kFindingKindNames.name(f.kind), f.text);
  return text;
}

/// Returns true if each seeded mistake is among the first findings, of which as many count as there are mistakes.
bool all_first(const diagnose::VerifyResult& r, const std::vector<Expected>& seeded) {
  // A mistake may need several findings, as two cables do; later ones only repeat the first.
  std::vector<bool> explained(seeded.size());
  for (const diagnose::Finding& f : r.findings) {
    bool any = false;
    for (std::size_t k = 0; k < seeded.size(); ++k) {
      if (!seeded[k].matches(f)) continue;
      explained[k] = any = true;
    }
    if (std::ranges::all_of(explained, [](bool e) { return e; })) return true;
    if (!any) return false;  // A wrong explanation precedes the right one.
  }
  return false;
}

/// Returns true if a wrong map was called dead hardware.
bool blames_hardware(const diagnose::VerifyResult& r, std::string_view kind) {
  const bool wrong_map = kind == "missing_strap" || kind == "wrong_straps" || kind == "doubled_address" ||
                         kind == "swapped_modules" || kind == "wrong_order" || kind == "swapped_across" ||
                         kind == "mirrored_patch" || kind == "swapped_lines" || kind == "swapped_cables" ||
                         kind == "rotated_module";
  return wrong_map && std::ranges::any_of(r.findings, [](const diagnose::Finding& f) {
           return f.kind == FindingKind::kAbsentModule || f.kind == FindingKind::kMissingJoint ||
                  f.kind == FindingKind::kNoTouchResponse;
         });
}

std::map<std::string_view, Score> singles(int seeds, int& blamed) {
  std::map<std::string_view, Score> scores;
  for (const Mistake& m : mistakes()) {
    for (const design::Design& d : designs()) {
      for (int seed = 0; seed < seeds; ++seed) {
        std::mt19937_64 random(static_cast<std::uint64_t>(seed) * 7919 + 1);
        Hardware h(d);
        h.verify_at_us = kVerifyAt_us;
        const auto expected = m.seed(h, random);
        if (!expected) continue;
        const diagnose::VerifyResult r = verify_built(h);
        const bool right = all_first(r, {*expected});
        scores[m.name].count(right);
        if (!right && std::getenv("TRISKIN_SHOW_MISSES") != nullptr)
          std::printf("MISS %s on %s seed %d (module %d)\n%s\n", std::string(m.name).c_str(), d.name.c_str(), seed,
                      expected->modules.empty() ? -1 : *expected->modules.begin(), told(r).c_str());
        blamed += blames_hardware(r, m.name) ? 1 : 0;
      }
    }
  }
  return scores;
}

std::map<std::string_view, Score> pairs(int seeds, Score& total) {
  std::map<std::string_view, Score> scores;
  const auto all = designs();
  for (std::size_t a = 0; a < mistakes().size(); ++a) {
    for (std::size_t b = a; b < mistakes().size(); ++b) {
      const Mistake &first = mistakes()[a], &second = mistakes()[b];
      if (first.hides_others || second.hides_others) continue;
      for (int seed = 0; seed < seeds; ++seed) {
        const design::Design& d = all[(a + b + static_cast<std::size_t>(seed)) % all.size()];
        std::mt19937_64 random(static_cast<std::uint64_t>(seed) * 104729 + a * 131 + b);
        Hardware h(d);
        h.verify_at_us = kVerifyAt_us;
        const auto one = first.seed(h, random);
        const auto two = one ? second.seed(h, random) : std::nullopt;
        if (!two) continue;
        const diagnose::VerifyResult r = verify_built(h);
        const bool right = all_first(r, {*one, *two});
        for (const std::string_view name : {first.name, second.name}) scores[name].count(right);
        total.count(right);
        total.exact += right && r.findings.size() == 2 ? 1 : 0;
        if (!right && std::getenv("TRISKIN_SHOW_MISSES") != nullptr)
          std::printf("MISS %s (module %d) + %s (module %d) on %s seed %d\n%s\n", std::string(first.name).c_str(),
                      one->modules.empty() ? -1 : *one->modules.begin(), std::string(second.name).c_str(),
                      two->modules.empty() ? -1 : *two->modules.begin(), d.name.c_str(), seed, told(r).c_str());
      }
    }
  }
  return scores;
}

TEST(SeededMistakes, there_are_twenty_kinds_and_each_can_be_seeded) {
  EXPECT_GE(mistakes().size(), 20U);
  for (const Mistake& m : mistakes()) {
    int seeded = 0;
    for (const design::Design& d : designs()) {
      Hardware h(d);
      std::mt19937_64 random(1);
      seeded += m.seed(h, random) ? 1 : 0;
    }
    EXPECT_GT(seeded, 0) << m.name;
  }
}

TEST(SeededMistakes, alone_the_right_explanation_is_first) {
  int blamed = 0;
  Score total;
  for (const auto& [name, score] : singles(2, blamed)) {
    total.right += score.right;
    total.all += score.all;
  }
  EXPECT_GE(total.all, 150);
  EXPECT_GE(total.percent(), 95.0);
  EXPECT_EQ(blamed, 0);
}

TEST(SeededMistakes, a_healthy_skin_has_no_findings) {
  for (const design::Design& d : designs()) EXPECT_EQ(told(verify_built(Hardware(d))), "");
}

TEST(SeededMistakes, in_pairs_both_explanations_are_first) {
  Score total;
  (void)pairs(1, total);
  EXPECT_GE(total.all, 200);
  EXPECT_GE(total.percent(), 85.0);
}

TEST(SeededMistakes, twenty_pairs_on_strapped_patches_have_one_finding_for_each_cause) {
  // Two exchanged cables give one finding per pair, and hide the modules connected to them; these mistakes do not.
  const std::vector<std::string_view> names{"dead_chip",     "wrong_chip",   "missing_strap", "swapped_modules",
                                            "swapped_lines", "broken_joint", "loose_joint",   "saturated_module"};
  int pairs = 0, exact = 0;
  for (std::size_t a = 0; a < names.size(); ++a) {
    for (std::size_t b = a + 1; b < names.size() && pairs < 20; ++b) {
      std::mt19937_64 random(a * 131 + b);
      Hardware h(blob({16, 16, 7}, 2));
      h.verify_at_us = kVerifyAt_us;
      const auto one = std::ranges::find(mistakes(), names[a], &Mistake::name)->seed(h, random);
      const auto two = one ? std::ranges::find(mistakes(), names[b], &Mistake::name)->seed(h, random) : std::nullopt;
      if (!two) continue;
      ++pairs;
      const diagnose::VerifyResult r = verify_built(h);
      const bool both = all_first(r, {*one, *two}) && r.findings.size() == 2;
      exact += both ? 1 : 0;
      EXPECT_TRUE(both) << names[a] << " and " << names[b] << "\n" << told(r);
    }
  }
  EXPECT_EQ(pairs, 20);
  EXPECT_EQ(exact, pairs);
}

// Compares with the table of docs/measurements/device.md; TRISKIN_WRITE_TABLES=1 writes it (tools/make_mistake_table).
TEST(SeededMistakes, long_the_table_in_the_docs_is_what_was_measured) {
  int blamed = 0;
  Score alone_total, pair_total;
  const auto alone = singles(8, blamed);
  const auto in_pairs = pairs(3, pair_total);
  std::string table = "| mistake | what | alone | in pairs |\n|---|---|---|---|\n";
  for (const Mistake& m : mistakes()) {
    const Score& s = alone.at(m.name);
    alone_total.right += s.right;
    alone_total.all += s.all;
    const auto p = in_pairs.find(m.name);
    table +=
        fmt::format("| `{}` | {} | {} of {} | {} |\n", m.name, m.what, s.right, s.all,
                    p == in_pairs.end() ? std::string("–") : fmt::format("{} of {}", p->second.right, p->second.all));
  }
  table += fmt::format("| all | | {} of {} ({:.1f} %) | {} of {} ({:.1f} %) |\n", alone_total.right, alone_total.all,
                       alone_total.percent(), pair_total.right, pair_total.all, pair_total.percent());
  table += fmt::format("\nOf the pairs {} have exactly two findings, one for each mistake.\n", pair_total.exact);
  EXPECT_GE(alone_total.percent(), 95.0);
  EXPECT_GE(pair_total.percent(), 85.0);
  EXPECT_EQ(blamed, 0);
  const std::string page = source_folder() + "/docs/measurements/device.md";
  std::ifstream in(page);
  std::stringstream text;
  text << in.rdbuf();
  const std::string begin = "<!-- mistakes -->\n", end = "<!-- end -->";
  std::string old = text.str();
  const auto from = old.find(begin), until = old.find(end, from);
  ASSERT_NE(until, std::string::npos) << page << " has no place for the table";
  const std::string now = old.substr(0, from + begin.size()) + table + old.substr(until);
  if (std::getenv("TRISKIN_WRITE_TABLES") != nullptr)
    std::ofstream(page) << now;
  else
    EXPECT_EQ(now, old) << "run tools/make_mistake_table";
}

}  // namespace
}  // namespace triskin::test
