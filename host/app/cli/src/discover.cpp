// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "site_options.hpp"
#include "topology_report.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/files.hpp"
#include "triskin/base/writer_lock.hpp"
#include "triskin/deploy/board_shape.hpp"
#include "triskin/diagnose/board_report.hpp"
#include "triskin/robot/edit.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/firmware_version.hpp"
#include "triskin/session/patch_table.hpp"

namespace triskin::cli::discover_command {
namespace {

struct Options {
  std::string file, elf;
  connect::LinkOptions link;
  bool topology = false, note = false;
  std::vector<std::string> designs;
};

struct Found {
  nlohmann::json controllers = nlohmann::json::array();
  std::vector<std::string> lines;
  bool kernel = false;
};

// Adds the board's health, if the controller's firmware reports it.
void add_board(nlohmann::json& j, session::Controller& c, const std::string& elf) {
  const diagnose::BoardReport report = diagnose::report_board(c);
  if (!report.health) return;
  j["clock"] = diagnose::clock_text(report.health->clock);
  j["bus_offs"] = report.health->bus_offs;
  j["crashed"] = report.crash.has_value();
  j["remarks"] = diagnose::board_remarks(report, elf);
}

void add_lines(nlohmann::json& j, std::span<const wire::LineReport> lines) {
  j["chips"] = j["stuck_lines"] = nlohmann::json::array();
  for (std::size_t l = 0; l < lines.size(); ++l) {
    const wire::LineReport& line = lines[l];
    if (line.stuck) j["stuck_lines"].push_back(l);
    for (int a = 0; a < layout::kAddressesPerLine; ++a) {
      if ((line.answers >> a & 1) == 0) continue;
      j["chips"].push_back({{"line", l}, {"address", a}, {"right_id", (line.wrong_id >> a & 1) == 0}});
    }
  }
}

nlohmann::json ask(session::Bus& bus, const wire::NodeClaim& claim, const std::string& elf) {
  session::Controller c(bus, claim.node_address);
  const wire::Hello hello = c.hello();
  const wire::ActiveTable table = c.active_table();
  nlohmann::json j = {{"wire_version", hello.wire_version},
                      {"layout_version", hello.layout_version},
                      {"firmware", session::firmware_version_text(hello.firmware_version)}};
  if (table.present()) {
    j["design_id"] = fmt::format("{:016x}", table.design_id);
    j["table_modules"] = table.modules;
  }
  add_lines(j, c.discover());
  add_board(j, c, elf);
  return j;
}

// Returns the patch whose table the controller has. Its node address tells the patch only if the table is a backup,
// because a robot file gives other addresses than the design.
layout::PatchIndex expected_patch(const std::vector<NamedDesign>& designs, const wire::NodeClaim& claim,
                                  const wire::ActiveTable& table) {
  const auto named =
      std::ranges::find(designs, table.design_id, [](const NamedDesign& d) { return d.second.design_id; });
  if (!table.present() || named == designs.end()) return layout::PatchIndex::none();
  const layout::NodeAddress node{claim.node_address};
  const auto patch = session::patch_of_table(named->second, node, table.crc);
  return patch >= 0 ? patch : design::patch_at(named->second, node);
}

nlohmann::json ask_topology(session::Bus& bus, const wire::NodeClaim& claim, const std::vector<NamedDesign>& designs,
                            const Output& output) {
  session::Controller c(bus, claim.node_address);
  const wire::ActiveTable table = c.active_table();
  return report_topology(c, designs, table.design_id, expected_patch(designs, claim, table), output);
}

std::map<int, int> users_of(const std::vector<wire::NodeClaim>& claims) {
  std::map<int, int> users;
  for (const auto& c : claims) ++users[c.node_address];
  return users;
}

// Several controllers at one address would all answer, so they can be told apart but not asked.
nlohmann::json describe(session::Bus& bus, const wire::NodeClaim& claim, bool unique, const std::string& elf) {
  nlohmann::json j = unique ? ask(bus, claim, elf) : nlohmann::json::object();
  j["serial"] = session::to_text(claim.unique_id);
  j["node_address"] = claim.node_address;
  j["flashed"] = claim.has_table;
  j["address_unique"] = unique;
  return j;
}

std::string line_of(const nlohmann::json& j, const std::string& place) {
  const bool unique = j["address_unique"].get<bool>();
  return fmt::format("controller {}  node address {}{}  {}{}{}{}", j["serial"].get<std::string>(),
                     j["node_address"].get<int>(), unique ? "" : " (shared)",
                     j["flashed"].get<bool>() ? "flashed" : "not flashed",
                     unique ? fmt::format("  {}", counted(j["chips"].size(), "chip")) : std::string(),
                     j.contains("clock") ? "  " + j["clock"].get<std::string>() : std::string(), place);
}

bool opens_in_kernel(link::Link& link) {
  return link.open_channel(wire::physical_id(0, wire::kTesterAddress), wire::physical_id(wire::kTesterAddress, 0)) !=
         nullptr;
}

std::vector<wire::NodeClaim> claims_on(session::Bus& bus) {
  auto claims = bus.discover();
  if (claims.empty()) throw DeviceError(bus.nobody_answers());
  return claims;
}

// Returns the cover and patch that a controller serves; a linear search suffices, because a bus has few covers.
std::string place_on(const robot::BusConfig& site, nlohmann::json& j) {
  if (!j.contains("design_id")) return "";
  const std::string id = j["design_id"].get<std::string>();
  for (const robot::CoverConfig& cover : site.covers) {
    const auto patch = design::patch_at(cover.design, layout::NodeAddress{j["node_address"].get<int>()});
    if (patch < 0 || id != fmt::format("{:016x}", cover.design.design_id)) continue;
    j["cover"] = cover.name;
    j["patch"] = patch;
    return fmt::format("  {}patch {}", cover.name.empty() ? "" : cover.name + ", ", patch);
  }
  return "  of another design";
}

// Returns problems that the board reports about itself, one line each.
std::vector<std::string> remarks_of(const nlohmann::json& j) {
  return j.contains("remarks") ? j["remarks"].get<std::vector<std::string>>() : std::vector<std::string>{};
}

Found look_at(skin::LiveBus& live, const std::string& elf) {
  Found found;
  session::Bus& bus = live.bus();
  const auto claims = claims_on(bus);
  auto users = users_of(claims);
  for (const auto& claim : claims) {
    nlohmann::json j = describe(bus, claim, users[claim.node_address] == 1, elf);
    j["bus"] = live.config().name;
    const std::string place = place_on(live.config(), j);
    found.lines.push_back(line_of(j, place));
    for (const std::string& remark : remarks_of(j)) found.lines.push_back("  " + remark);
    found.controllers.push_back(std::move(j));
  }
  found.kernel = opens_in_kernel(live.link());
  return found;
}

// Writes the serial numbers of the controllers that serve a cover into the robot file.
int note_serials(const std::string& file, const nlohmann::json& controllers) {
  const WriterLock lock(file);
  robot::Robot robot = robot::read_robot(file);
  int noted = 0;
  for (const nlohmann::json& c : controllers) {
    if (!c.contains("cover")) continue;
    robot::CoverEntry* cover = robot::find_cover(robot, c["cover"].get<std::string>());
    if (cover == nullptr) continue;
    for (robot::ControllerEntry& e : cover->controllers) {
      if (e.patch != c["patch"].get<int>() || e.serial == c["serial"].get<std::string>()) continue;
      e.serial = c["serial"].get<std::string>();
      ++noted;
    }
  }
  if (noted > 0) write_file_atomically(file, robot::robot_text(robot));
  return noted;
}

int run_robot(const Options& options, Output& output) {
  if (options.topology) throw InputError("discover: --topology looks at one link; give --link and a design file");
  skin::LiveSkin skin = open_skin({options.file, "", options.link}, output);
  std::vector<Found> buses(skin.buses().size());
  skin.on_each_bus([&](skin::LiveBus& bus) { buses[bus.index()] = look_at(bus, options.elf); });
  nlohmann::json controllers = nlohmann::json::array();
  bool kernel = false;
  for (std::size_t b = 0; b < buses.size(); ++b) {
    output.say(fmt::format("bus {}: {}", skin.site().buses[b].name, skin.links()[b]->name()));
    for (const std::string& line : buses[b].lines) output.say("  " + line);
    for (auto& c : buses[b].controllers) controllers.push_back(std::move(c));
    kernel = kernel || buses[b].kernel;
  }
  output.result = {{"iso_tp", kernel ? "kernel" : "program"}};
  if (options.note) {
    const int noted = note_serials(options.file, controllers);
    output.result["noted"] = noted;
    output.say(fmt::format("{}: {} written", options.file, counted(noted, "serial number")));
  }
  output.result["controllers"] = std::move(controllers);
  return 0;
}

int run_link(const Options& options, Output& output) {
  if (options.note) throw InputError("discover: --note writes into a robot file; give one");
  std::vector<NamedDesign> designs;
  std::optional<robot::Site> site;
  if (!options.file.empty()) {
    site = robot::read_site(options.file);
    designs.emplace_back(options.file, site->buses.front().covers.front().design);
  }
  for (const std::string& file : options.designs) designs.emplace_back(file, design::read_intact_design(file));
  const bool simulated = options.link.scene.empty() && !designs.empty();
  const auto link = connect::open_link(options.link, simulated ? &designs[0].second : nullptr);
  say_simulated(*link, output);
  session::Bus bus(*link);
  auto claims = claims_on(bus);
  if (options.topology) claims = deploy::put_apart(bus, std::move(claims), false);
  auto users = users_of(claims);
  nlohmann::json controllers = nlohmann::json::array();
  bool bad = false;
  for (const auto& claim : claims) {
    const bool unique = users[claim.node_address] == 1;
    nlohmann::json j = describe(bus, claim, unique, options.elf);
    output.say(line_of(j, site ? place_on(site->buses.front(), j) : ""));
    for (const std::string& remark : remarks_of(j)) output.say("  " + remark);
    if (options.topology && unique) {
      j["topology"] = ask_topology(bus, claim, designs, output);
      bad = bad || differs(j["topology"]);
    }
    controllers.push_back(std::move(j));
  }
  output.result = {{"controllers", std::move(controllers)}, {"iso_tp", opens_in_kernel(*link) ? "kernel" : "program"}};
  return bad ? 1 : 0;
}

int run(const Options& options, Output& output) {
  const bool is_robot = !options.file.empty() && robot::is_robot_file(options.file);
  return is_robot ? run_robot(options, output) : run_link(options, output);
}

const Registration kDiscover{{
    "discover",
    "list the controllers on a link and what answers on their lines",
    "triskin discover forearm.json --link sim",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("DESIGN", options->file,
                     "design file, or robot file: which patch each controller serves; or only --link");
      add_link_options(app, options->link);
      app.add_flag("--note", options->note, "with a robot file: write the serial numbers into it");
      app.add_flag(
          "--topology", options->topology,
          "let controllers of switched modules find their modules and joints (interrupts sampling for up to 60 ms)");
      app.add_option("--design", options->designs,
                     "further design files for --topology: recognizes their patches, even those never flashed");
      app.add_option("--elf", options->elf,
                     "image of the firmware (triskin_app_a.elf or _b): names function and line of a crash");
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kHardware,
}};

}  // namespace
}  // namespace triskin::cli::discover_command
