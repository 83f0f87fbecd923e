// SPDX-License-Identifier: GPL-3.0-or-later
// The campaign of docs/silicon.md: patches whose converters are drawn from the whole of their ranges.
#include <fmt/format.h>

#include <vector>

#include "bench.hpp"
#include "sim/hardware/converter_campaign.hpp"

namespace triskin::cli {
namespace {

// What is borne beyond the ranges: all chips have the value, the other properties are drawn.
struct Edge {
  const char* name;
  double hardware::Ad7147Behaviour::* property;
  std::vector<double> values;
};
using hardware::Ad7147Behaviour;
const std::vector<Edge> kEdges{
    {"step_counts", &Ad7147Behaviour::step_counts, {600, 700, 1800, 2000}},
    {"neg_step_ratio", &Ad7147Behaviour::neg_step_ratio, {0.7, 0.8, 1.2, 1.3}},
    {"step_bend", &Ad7147Behaviour::step_bend, {-0.3, -0.15, 0.15, 0.3}},
    {"step_unevenness", &Ad7147Behaviour::step_unevenness, {0.1, 0.2, 0.3}},
    {"gain", &Ad7147Behaviour::gain, {0.5, 0.65, 1.35, 1.5}},
    {"stage_memory", &Ad7147Behaviour::stage_memory, {0.01, 0.05, 0.2}},
    {"zero_counts", &Ad7147Behaviour::zero_counts, {-2000, 2000, 4000}},
    {"neg_extra_counts", &Ad7147Behaviour::neg_extra_counts, {2000, 4000}},
    {"path_spread_counts", &Ad7147Behaviour::path_spread_counts, {30, 40, 60}},
    {"neg_gain_ratio", &Ad7147Behaviour::neg_gain_ratio, {0.95, 0.96, 1.04, 1.05}},
    {"stage_gain_spread", &Ad7147Behaviour::stage_gain_spread, {0.003, 0.005, 0.01}},
    {"curve_counts", &Ad7147Behaviour::curve_counts, {-400, -200, 200, 400}},
    {"noise", &Ad7147Behaviour::noise, {4, 8, 16}},
    {"wander_counts", &Ad7147Behaviour::wander_counts, {5, 10, 20}},
    {"period_error", &Ad7147Behaviour::period_error, {-0.13, -0.12, 0.12, 0.13}},
    {"first_error_counts", &Ad7147Behaviour::first_error_counts, {20, 40, 60}},
    {"bus_coupling_counts", &Ad7147Behaviour::bus_coupling_counts, {50, 100, 200, 400, 800}},
};

nlohmann::json rows(const BenchOptions& options, Output& output) {
  const int patches = options.quick ? 60 : 340;  // of each of seven kinds
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
  for (const Edge& edge : kEdges) {
    for (const double value : edge.values) {
      int healthy = 0, refused = 0;
      const auto set = [&](hardware::Ad7147Behaviour& chip) { chip.*edge.property = value; };
      for (int k = 0; k < (options.quick ? 4 : 20); ++k) {
        const test::PatchResult r =
            test::CampaignPatch(kFirstSeed + static_cast<std::uint32_t>(k), test::PatchFault::kNone, set).run();
        healthy += r.healthy;
        refused += r.refused;
      }
      result.push_back({{"property", edge.name}, {"value", value}, {"healthy", healthy}, {"refused", refused}});
      output.say(fmt::format("{:20} {:6}: {} of {} healthy modules refused", edge.name, value, refused, healthy));
    }
  }
  return result;
}

const BenchSubject kConverters("converters", "patches of drawn converters: what is refused, which fault is missed",
                               rows);

}  // namespace
}  // namespace triskin::cli
