// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "topology_report.hpp"
#include "triskin/cli/link_options.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::cli {
namespace {

struct Options {
  device::LinkOptions link;
  bool topology = false;
  std::vector<std::string> designs;
};

nlohmann::json ask(device::Bus& bus, const wire::NodeClaim& claim) {
  device::Controller c(bus, claim.node_address);
  const wire::Hello hello = c.hello();
  const wire::ActiveTable table = c.active_table();
  nlohmann::json j = {
      {"wire_version", hello.wire_version},
      {"layout_version", hello.layout_version},
      {"firmware", fmt::format("{}.{}.{}", hello.firmware_version >> 24 & 0xFF, hello.firmware_version >> 16 & 0xFF,
                               hello.firmware_version >> 8 & 0xFF)}};
  if (table.present()) {
    j["design_id"] = fmt::format("{:016x}", table.design_id);
    j["table_modules"] = table.modules;
  }
  nlohmann::json chips = nlohmann::json::array();
  nlohmann::json stuck = nlohmann::json::array();
  const auto lines = c.discover();
  for (int l = 0; l < layout::kLines; ++l) {
    const auto& line = lines[static_cast<std::size_t>(l)];
    if (line.stuck) stuck.push_back(l);
    for (int a = 0; a < layout::kAddressesPerLine; ++a) {
      if ((line.answers >> a & 1) == 0) continue;
      chips.push_back({{"line", l}, {"address", a}, {"right_id", (line.wrong_id >> a & 1) == 0}});
    }
  }
  j["chips"] = std::move(chips);
  j["stuck_lines"] = std::move(stuck);
  return j;
}

nlohmann::json ask_topology(device::Bus& bus, const wire::NodeClaim& claim, const std::vector<NamedDesign>& designs,
                            const Output& output) {
  device::Controller c(bus, claim.node_address);
  const wire::ActiveTable table = c.active_table();
  return report_topology(c, designs, table.design_id, table.present() ? claim.node_address - 1 : -1, output);
}

int run(const Options& options, Output& output) {
  std::vector<NamedDesign> designs;
  for (const std::string& file : options.designs) designs.emplace_back(file, design::read_intact_design(file));
  const bool simulated = options.link.scene.empty() && !designs.empty();
  const auto link = device::open_link(options.link, simulated ? &designs[0].second : nullptr);
  device::Bus bus(*link);
  const auto claims = bus.discover();
  if (claims.empty())
    throw DeviceError(fmt::format("{}: no controller answers; check power, cable and bit rate", link->name()));
  std::map<int, int> users;
  for (const auto& c : claims) ++users[c.node_address];
  nlohmann::json controllers = nlohmann::json::array();
  bool bad = false;
  for (const auto& claim : claims) {
    // Several controllers at one address would all answer: they can be told apart, but not asked.
    const bool unique = users[claim.node_address] == 1;
    nlohmann::json j = unique ? ask(bus, claim) : nlohmann::json::object();
    j["serial"] = device::to_text(claim.unique_id);
    j["node_address"] = claim.node_address;
    j["flashed"] = claim.has_table;
    j["address_unique"] = unique;
    output.say(fmt::format("controller {}  node address {}{}  {}{}", device::to_text(claim.unique_id),
                           claim.node_address, unique ? "" : " (shared)", claim.has_table ? "flashed" : "not flashed",
                           unique ? fmt::format("  {} chips", j["chips"].size()) : std::string()));
    if (options.topology && unique) {
      j["topology"] = ask_topology(bus, claim, designs, output);
      bad = bad || differs(j["topology"]);
    }
    controllers.push_back(std::move(j));
  }
  const bool kernel = link->open_channel(wire::physical_id(0, wire::kTesterAddress),
                                         wire::physical_id(wire::kTesterAddress, 0)) != nullptr;
  output.result = {{"controllers", std::move(controllers)}, {"iso_tp", kernel ? "kernel" : "program"}};
  return bad ? 1 : 0;
}

const Registration kDiscover{{
    "discover",
    "list the controllers on a link and what answers on their lines",
    "triskin discover --link sim --scene forearm.json",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      add_link_options(app, options->link);
      app.add_flag(
          "--topology", options->topology,
          "let controllers of switched modules find their modules and joints; interrupts sampling for up to 60 ms");
      app.add_option(
          "--design", options->designs,
          "design files that the topology is compared with; also recognizes patches that were never flashed");
      return [options](Output& output) { return run(*options, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli
