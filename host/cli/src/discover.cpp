// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <map>
#include <memory>

#include "triskin/cli/link_options.hpp"
#include "triskin/device/controller.hpp"

namespace triskin::cli {
namespace {

nlohmann::json ask(device::Bus& bus, const wire::NodeClaim& claim) {
  device::Controller c(bus, claim.node_address);
  const device::Hello hello = c.hello();
  const device::ActiveTable table = c.active_table();
  nlohmann::json j = {{"wire_version", hello.wire_version}, {"layout_version", hello.layout_version},
                      {"firmware", fmt::format("{}.{}.{}", hello.firmware_version >> 24 & 0xFF, hello.firmware_version >> 16 & 0xFF,
                                               hello.firmware_version >> 8 & 0xFF)}};
  if (table.present) {
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

int run(const device::LinkOptions& options, Output& output) {
  const auto link = device::open_link(options, nullptr);
  device::Bus bus(*link);
  const auto claims = bus.discover();
  if (claims.empty()) throw DeviceError(fmt::format("{}: no controller answers; check power, cable and bit rate", link->name()));
  std::map<int, int> users;
  for (const auto& c : claims) ++users[c.node_address];
  nlohmann::json controllers = nlohmann::json::array();
  for (const auto& claim : claims) {
    // Several controllers at one address would all answer: they can be told apart, but not asked.
    const bool unique = users[claim.node_address] == 1;
    nlohmann::json j = unique ? ask(bus, claim) : nlohmann::json::object();
    j["serial"] = device::to_text(claim.unique_id);
    j["node_address"] = claim.node_address;
    j["flashed"] = claim.has_table;
    j["address_unique"] = unique;
    output.say(fmt::format("controller {}  node address {}{}  {}{}", device::to_text(claim.unique_id), claim.node_address,
                           unique ? "" : " (shared)", claim.has_table ? "flashed" : "not flashed",
                           unique ? fmt::format("  {} chips", j["chips"].size()) : std::string()));
    controllers.push_back(std::move(j));
  }
  output.result = {{"controllers", std::move(controllers)}};
  return 0;
}

const Registration kDiscover{{
    "discover", "list the controllers on a link and what answers on their lines", "triskin discover --link sim --scene forearm.json",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<device::LinkOptions>();
      add_link_options(app, *options);
      return [options](Output& output) { return run(*options, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli
