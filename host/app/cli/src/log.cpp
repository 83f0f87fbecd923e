// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "site_options.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/base/names.hpp"
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
  SiteOptions site;
  std::string elf, level = "information";
  int node = 0;
  double seconds = 0.0;
};

std::vector<std::uint8_t> nodes_of(const Answering& found, const session::Bus& bus, int only) {
  std::vector<std::uint8_t> nodes;
  for (const wire::NodeClaim& claim : found.claims) nodes.push_back(claim.node_address);
  if (nodes.empty())
    throw DeviceError(only == 0 ? bus.nobody_answers()
                                : fmt::format("{}: no controller answers at node address {}", bus.name(), only));
  std::ranges::sort(nodes);
  if (std::ranges::adjacent_find(nodes) != nodes.end())
    throw DeviceError(
        fmt::format("{}: controllers share a node address; give each its own with triskin flash first", bus.name()));
  return nodes;
}

// What all buses said; each has a thread.
class Heard {
 public:
  explicit Heard(Output& output) : output_(output) {}

  void add(const OpenBus& at, const char* list, std::string_view text, nlohmann::json row) {
    const std::lock_guard lock(guard_);
    output_.say(fmt::format("{}{}", at.prefix(), text));
    if (at.config != nullptr && !at.config->name.empty()) row["bus"] = at.config->name;
    lists_[list].push_back(std::move(row));
  }
  void add_lost(const OpenBus& at, std::uint64_t lines) {
    if (lines == 0) return;
    const std::lock_guard lock(guard_);
    output_.say(fmt::format("{}{} {} lost", at.prefix(), counted(lines, "line"), agreeing(lines, "was", "were")));
    lost_ += lines;
  }
  void add_missing(const OpenBus& at, const std::vector<std::string>& missing) {
    if (missing.empty()) return;
    const std::lock_guard lock(guard_);
    output_.say(fmt::format("{}{} {} not answer; check power and cable", at.prefix(), fmt::join(missing, ", "),
                            agreeing(missing.size(), "does", "do")));
    for (const std::string& who : missing) lists_["missing"].push_back(at.prefix() + who);
  }
  int conclude() {
    output_.result = std::move(lists_);
    output_.result["lost"] = lost_;
    return lost_ > 0 || !output_.result["missing"].empty() ? 1 : 0;
  }

 private:
  Output& output_;
  std::mutex guard_;
  nlohmann::json lists_ = {
      {"crashes", nlohmann::json::array()}, {"lines", nlohmann::json::array()}, {"missing", nlohmann::json::array()}};
  std::uint64_t lost_ = 0;
};

// After a power failure the log does not contain a crash, but the fault memory still does.
void say_crashes(const OpenBus& at, const std::vector<std::uint8_t>& nodes, const std::string& elf, Heard& heard) {
  for (const std::uint8_t node : nodes) {
    const auto crash = session::Controller(at.bus, node).crash();
    if (!crash) continue;
    const std::string text = diagnose::crash_text(*crash, elf);
    heard.add(at, "crashes", fmt::format("controller {} {}", node, text), {{"node_address", node}, {"text", text}});
  }
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
  Heard heard(output);
  on_each_bus(options.site, output, [&](const OpenBus& at) {
    const Answering found = find_controllers(at, options.node);
    const auto nodes = nodes_of(found, at.bus, options.node);
    heard.add_missing(at, found.missing);
    say_crashes(at, nodes, options.elf, heard);
    session::LogReader reader(at.bus, nodes, kLevelNames.value(options.level).value(), [&](const session::LogEntry& e) {
      const std::string text = options.elf.empty() ? e.text : diagnose::name_places(e.text, options.elf);
      heard.add(at, "lines", fmt::format("{:3} {:10.3f} {:11} {}", e.node, e.time_s, kLevelNames.name(e.level), text),
                {{"node_address", e.node}, {"time_s", e.time_s}, {"level", kLevelNames.name(e.level)}, {"text", text}});
    });
    follow(reader, at.bus, options.seconds);
    reader.finish();
    heard.add_lost(at, reader.lost());
  });
  return heard.conclude();
}

const Registration kLog{{
    "log",
    "show what controllers write into their logs, and what stopped them last",
    "triskin log --link sim --scene forearm.json --seconds 2",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("DESIGN", options->site.file, "design file, or robot file: all of its buses; or only --link");
      add_link_options(app, options->site.link);
      app.add_option("--node", options->node, "only the controller at this node address, 1 … 126")
          ->check(CLI::Range(1, 126));
      app.add_option("--level", options->level, "lowest level that is shown")
          ->check(CLI::IsMember({"error", "warning", "information", "debug"}))
          ->capture_default_str();
      app.add_option("--seconds", options->seconds, "how long to read (default: until Ctrl-C)")
          ->check(CLI::PositiveNumber);
      app.add_option("--elf", options->elf,
                     "image of the firmware (triskin_app_a.elf or _b): function and line in place of addresses");
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kHardware,
}};

}  // namespace
}  // namespace triskin::cli::log_command
