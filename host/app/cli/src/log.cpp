// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command.hpp"
#include "link_options.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/base/names.hpp"
#include "triskin/design/design.hpp"
#include "triskin/diagnose/board_report.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/log_reader.hpp"

namespace triskin::cli::log_command {
namespace {

constexpr NameTable kLevelNames{
    std::array<std::pair<wire::LogLevel, std::string_view>, 4>{{{wire::LogLevel::kError, "error"},
                                                                {wire::LogLevel::kWarning, "warning"},
                                                                {wire::LogLevel::kInformation, "information"},
                                                                {wire::LogLevel::kDebug, "debug"}}}};

struct Options {
  connect::LinkOptions link;
  std::string design, elf, level = "information";
  int node = 0;
  double seconds = 0.0;
};

std::vector<std::uint8_t> nodes_on(session::Bus& bus, int only) {
  std::vector<std::uint8_t> nodes;
  for (const wire::NodeClaim& claim : bus.discover()) {
    if (only == 0 || claim.node_address == only) nodes.push_back(claim.node_address);
  }
  if (nodes.empty())
    throw DeviceError(only == 0 ? bus.nobody_answers()
                                : fmt::format("{}: no controller answers at node address {}", bus.name(), only));
  std::ranges::sort(nodes);
  if (std::ranges::adjacent_find(nodes) != nodes.end())
    throw DeviceError(
        fmt::format("{}: controllers share a node address; give each its own with triskin flash first", bus.name()));
  return nodes;
}

// After a power failure the log does not contain a crash, but the fault memory still does.
void say_crashes(session::Bus& bus, const std::vector<std::uint8_t>& nodes, const std::string& elf, Output& output) {
  nlohmann::json crashes = nlohmann::json::array();
  for (const std::uint8_t node : nodes) {
    const auto crash = session::Controller(bus, node).crash();
    if (!crash) continue;
    const std::string text = diagnose::crash_text(*crash, elf);
    output.say(fmt::format("controller {} {}", node, text));
    crashes.push_back({{"node_address", node}, {"text", text}});
  }
  output.result["crashes"] = std::move(crashes);
}

// Prints lines until the time is over or a person ends it.
void follow(session::LogReader& reader, session::Bus& bus, double seconds) {
  constexpr std::uint64_t kSlice_us = 100'000;
  const std::uint64_t end_us = seconds > 0.0 ? bus.now_us() + static_cast<std::uint64_t>(seconds * 1e6) : UINT64_MAX;
  try {
    while (bus.now_us() < end_us) reader.run_until(std::min(end_us, bus.now_us() + kSlice_us));
  } catch (const Cancelled&) {
    if (interrupt_signal() == 0) throw;
  }
}

int run(const Options& options, Output& output) {
  catch_interrupts();
  output.expect_interrupt();
  std::optional<design::Design> simulated;
  if (!options.design.empty()) simulated = design::read_intact_design(options.design);
  const auto link = connect::open_link(options.link, simulated ? &*simulated : nullptr);
  say_simulated(*link, output);
  session::Bus bus(*link);
  const auto nodes = nodes_on(bus, options.node);
  say_crashes(bus, nodes, options.elf, output);
  nlohmann::json lines = nlohmann::json::array();
  session::LogReader reader(bus, nodes, kLevelNames.value(options.level).value(), [&](const session::LogEntry& e) {
    const std::string text = options.elf.empty() ? e.text : diagnose::name_places(e.text, options.elf);
    output.say(fmt::format("{:3} {:10.3f} {:11} {}", e.node, e.time_s, kLevelNames.name(e.level), text));
    lines.push_back(
        {{"node_address", e.node}, {"time_s", e.time_s}, {"level", kLevelNames.name(e.level)}, {"text", text}});
  });
  follow(reader, bus, options.seconds);
  reader.finish();
  if (reader.lost() > 0)
    output.say(fmt::format("{} {} lost", counted(reader.lost(), "line"), agreeing(reader.lost(), "was", "were")));
  output.result["lines"] = std::move(lines);
  output.result["lost"] = reader.lost();
  return reader.lost() > 0 ? 1 : 0;
}

const Registration kLog{{
    "log",
    "show what controllers write into their logs, and what stopped them last",
    "triskin log --link sim --scene forearm.json --seconds 2",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("DESIGN", options->design, "design whose patches the link sim simulates; other links need none");
      add_link_options(app, options->link);
      app.add_option("--node", options->node, "only the controller at this node address, 1 … 126")
          ->check(CLI::Range(1, 126));
      app.add_option("--level", options->level,
                     "error, warning, information or debug: lines that matter less are left out")
          ->check(CLI::IsMember({"error", "warning", "information", "debug"}))
          ->capture_default_str();
      app.add_option("--seconds", options->seconds, "how long to read; without it until the program is asked to end")
          ->check(CLI::PositiveNumber);
      app.add_option("--elf", options->elf,
                     "image of the firmware (triskin_app_a.elf or _b): function and line in place of addresses");
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kHardware,
}};

}  // namespace
}  // namespace triskin::cli::log_command
