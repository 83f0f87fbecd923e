// SPDX-License-Identifier: GPL-3.0-or-later
// What a technician meets, against what verify finds: the table of docs/measurements/device.md.
#include <fmt/format.h>

#include "bench.hpp"
#include "device/diagnose/causes.hpp"

namespace triskin::cli {
namespace {

nlohmann::json rows(const BenchOptions& options, Output& output) {
  const int draws = options.quick ? 10 : 100;
  nlohmann::json result = nlohmann::json::array();
  for (std::size_t k = 0; k < test::kCauseNames.size(); ++k) {
    using Verdict = test::CauseDraw::Verdict;
    const double start_s = processor_s();
    const test::CauseScore s = test::score_of(static_cast<test::Cause>(k), 1000, draws);
    result.push_back({{"cause", test::kCauseNames[k]},
                      {"draws", s.draws},
                      {"right", s.of(Verdict::kRight)},
                      {"beside_another", s.of(Verdict::kBoth)},
                      {"wrong", s.of(Verdict::kWrong)},
                      {"several", s.of(Verdict::kMany)},
                      {"missed", s.of(Verdict::kMissed)},
                      {"found", s.found},
                      {"seconds", processor_s() - start_s}});
    std::string found;
    for (const auto& [kinds, count] : s.found) found += fmt::format("{}{} {}", found.empty() ? "" : "; ", count, kinds);
    output.say(fmt::format("| {} | {} | {} | {} | {} | {} | {} |", test::kCauseNames[k], s.of(Verdict::kRight),
                           s.of(Verdict::kBoth), s.of(Verdict::kWrong), s.of(Verdict::kMany), s.of(Verdict::kMissed),
                           found));
    for (const std::string& said : s.not_right) output.say("  " + said);
  }
  return result;
}

const BenchSubject kCauses("causes", "what a technician meets at a skin, against what verify finds", rows);

}  // namespace
}  // namespace triskin::cli
