// SPDX-License-Identifier: GPL-3.0-or-later
#include "topology_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ranges>

#include "triskin/base/counted.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/diagnose/topology.hpp"

namespace triskin::cli {
namespace {

using nlohmann::json;

json adjacency(const wire::FoundTopology& found) {
  json rows = json::array();
  for (std::size_t m = 0; m < found.count; ++m) {
    json ports = json::array();
    for (const std::uint8_t j : found.joints[m]) {
      if (j == 0)
        ports.push_back(nullptr);
      else
        ports.push_back({{"module", layout::joint_row(j)}, {"port", layout::joint_port(j)}});
    }
    rows.push_back(std::move(ports));
  }
  return rows;
}

int joints_in(const wire::FoundTopology& found) {
  const auto ends = std::ranges::count_if(found.joints | std::views::join, [](std::uint8_t j) { return j != 0; });
  return static_cast<int>(ends) / 2;
}

json route_json(const wire::ActiveRoute& a) {
  json rows = json::array();
  for (std::size_t r = 0; r < layout::kMaxModules; ++r) {
    if ((a.alive >> r & 1) != 0)
      rows.push_back({{"row", r},
                      {"parent", a.parent[r] == wire::kNoRow ? json(nullptr) : json(a.parent[r])},
                      {"parent_port", a.parent_port[r]}});
  }
  return {{"active", a.complete},           {"as_table", a.as_table},   {"least_depth", a.min_depth},
          {"second_cable", a.second_cable}, {"max_depth", a.max_depth}, {"shorts", a.shorts},
          {"unknown_modules", a.unknown},   {"looks", a.reroutes},      {"repairs", a.repairs},
          {"seconds", a.last_us * 1e-6},    {"rows", std::move(rows)}};
}

json match_json(const diagnose::TopologyMatch& match, const NamedDesign& named) {
  const design::Design& design = named.second;
  json differences = json::array();
  for (const auto& d : match.differences) {
    json j = {{"kind", diagnose::kFindingKindNames.name(d.kind)}, {"text", d.text}, {"remedy", d.remedy}};
    j["module"] = d.module >= 0 ? json(design::number_of(design, d.module)) : json(nullptr);
    if (d.other >= 0) j["other"] = design::number_of(design, d.other);
    if (d.steps > 0) j["degrees"] = 120 * d.steps;
    differences.push_back(std::move(j));
  }
  return {{"design", named.first},
          {"patch", match.patch},
          {"modules", design::numbers_of(design, match.module_of)},
          {"joints", match.agreeing_joints},
          {"differences", std::move(differences)}};
}

// Returns the best patches over all designs, sorted by differences.
std::vector<std::pair<std::size_t, diagnose::TopologyMatch>> recognize(const wire::FoundTopology& found,
                                                                       const std::vector<NamedDesign>& designs) {
  std::vector<std::pair<std::size_t, diagnose::TopologyMatch>> best;
  for (std::size_t d = 0; d < designs.size(); ++d) {
    for (auto& match : diagnose::identify_patch(found, designs[d].second)) best.emplace_back(d, std::move(match));
  }
  std::size_t fewest = ~std::size_t{0};
  for (const auto& [d, m] : best) fewest = std::min(fewest, m.differences.size());
  std::erase_if(best, [&](const auto& b) { return b.second.differences.size() > fewest; });
  return best;
}

void say_found(const wire::FoundTopology& found, const wire::ActiveRoute& route, const Output& output) {
  output.say(fmt::format("  {}, {}, {} at port {}, {:.1f} ms{}", counted(found.count, "module"),
                         counted(joints_in(found), "joint"), found.second_cable ? "second cable" : "cable",
                         "ABC"[found.cable_port], route.last_us * 1e-3,
                         found.complete ? "" : "; the chain did not settle; there may be more"));
  for (std::size_t m = 0; m < found.count; ++m) {
    std::string line = fmt::format("    {:2}", m);
    for (std::size_t p = 0; p < layout::kPorts; ++p) {
      const std::uint8_t j = found.joints[m][p];
      line += j == 0 ? fmt::format("  {} -", "ABC"[p])
                     : fmt::format("  {} {}.{}", "ABC"[p], layout::joint_row(j), "ABC"[layout::joint_port(j)]);
    }
    output.say(line);
  }
}

void say_match(const json& match, const Output& output) {
  const json& differences = match["differences"];
  output.say(fmt::format(
      "  {} patch {}: {}", match["design"].get<std::string>(), match["patch"].get<int>(),
      differences.empty() ? "every port and rotation as designed" : fmt::format("{} differences", differences.size())));
  for (const json& d : differences)
    output.say(fmt::format("    {}: {}\n      {}", d["kind"].get<std::string>(), d["text"].get<std::string>(),
                           d["remedy"].get<std::string>()));
}

// The table of the controller names a design and a patch; a patch of −1 means that it is none of the given designs.
struct Expected {
  std::uint64_t design_id = 0;
  int patch = -1;
};

json report_recognized(const wire::FoundTopology& found, const std::vector<NamedDesign>& designs,
                       const Expected& expected, const Output& output) {
  json recognized = json::array();
  for (const auto& [d, match] : recognize(found, designs)) {
    if (match.another_patch()) continue;
    recognized.push_back(match_json(match, designs[d]));
    if (match.patch == expected.patch && designs[d].second.design_id == expected.design_id) continue;
    output.say(expected.patch >= 0 ? "  better matches:" : "  recognized:");
    say_match(recognized.back(), output);
  }
  if (!designs.empty() && recognized.empty()) output.say("  no patch of the given designs");
  if (recognized.size() > 1)
    output.say("  these patches look alike: triskin identify tells by touch which one it is, or name it with --assign");
  return recognized;
}

}  // namespace

json report_topology(session::Controller& controller, const std::vector<NamedDesign>& designs,
                     std::uint64_t expected_design, layout::PatchIndex expected_patch, const Output& output) {
  controller.reroute();
  const wire::FoundTopology found = controller.topology();
  const wire::ActiveRoute route = controller.route();
  json j = {{"switched", found.switched}};
  if (!found.switched) {
    output.say("  no answer on the route chain: strapped modules, or no power");
    return j;
  }
  j.update({{"complete", found.complete},
            {"modules", found.count},
            {"joints", joints_in(found)},
            {"cable_port", found.cable_port},
            {"adjacency", adjacency(found)},
            {"route", route_json(route)}});
  say_found(found, route, output);
  const auto named =
      std::ranges::find(designs, expected_design, [](const NamedDesign& d) { return d.second.design_id; });
  const bool expected = named != designs.end() && design::has_patch(named->second, expected_patch);
  if (expected) {
    const auto match = diagnose::match_topology(found, named->second, expected_patch);
    j["match"] = match_json(match, *named);
    j["another_patch"] = match.another_patch();
    say_match(j["match"], output);
    if (match.differences.empty()) return j;
  }
  j["recognized"] =
      report_recognized(found, designs, expected ? Expected{expected_design, expected_patch} : Expected{}, output);
  j["ambiguous"] = j["recognized"].size() > 1;
  return j;
}

bool differs(const json& topology) {
  if (topology.contains("match")) return !topology["match"]["differences"].empty();
  if (!topology.contains("recognized")) return false;
  const json& list = topology["recognized"];
  return list.empty() || !list[0]["differences"].empty();
}

}  // namespace triskin::cli
