// SPDX-License-Identifier: GPL-3.0-or-later
// The campaign of docs/silicon.md: patches whose converters are drawn from the whole of their ranges.
#include <fmt/format.h>

#include "bench.hpp"
#include "sim/hardware/converter_campaign.hpp"

namespace triskin::cli {
namespace {

nlohmann::json rows(const BenchOptions& options, Output& output) {
  const int patches = options.quick ? 60 : 340;  // of each of six kinds
  constexpr std::uint32_t kFirstSeed = 1000;
  const double start_s = processor_s();
  nlohmann::json result = nlohmann::json::array();
  for (const auto& [fault, c] : test::run_campaign(patches, kFirstSeed)) {
    const char* name = test::kPatchFaultNames[static_cast<std::size_t>(fault)];
    result.push_back({{"fault", name},
                      {"patches", c.patches},
                      {"healthy", c.healthy},
                      {"refused", c.refused},
                      {"faulty", c.faulty},
                      {"missed", c.missed},
                      {"seconds", processor_s() - start_s}});
    output.say(fmt::format("{:16} {:4} patches: {} of {} healthy modules refused, {} of {} faulty ones missed", name,
                           c.patches, c.refused, c.healthy, c.missed, c.faulty));
    for (const std::string& d : c.descriptions) output.say("  " + d);
  }
  return result;
}

const BenchSubject kConverters("converters", "patches of drawn converters: what is refused, which fault is missed",
                               rows);

}  // namespace
}  // namespace triskin::cli
