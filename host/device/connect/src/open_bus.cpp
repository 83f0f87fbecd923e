// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/connect/open_bus.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "triskin/base/counted.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/hardware/tcp_link.hpp"
#include "triskin/hardware/virtual_skin.hpp"
#include "triskin/link/link_kind.hpp"
#include "triskin/robot/assembly.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::connect {
namespace {

std::string link_of(const robot::Site& site, std::size_t bus, const LinkOptions& options) {
  if (!options.chosen && options.scene.empty()) return site.buses[bus].link;
  if (!options.link.starts_with("sim:")) {
    if (options.link == link::kSimulatedBus)
      return link::is_usb(site.buses[bus].link) ? link::kSimulatedHub : link::kSimulatedBus;
    if (options.link == link::kSimulatedHub || site.buses.size() == 1) return options.link;
    throw InputError(fmt::format(
        "--link {}: {} has {}; its file names their links, only sim or sim:HOST:PORT can stand for all of them",
        options.link, site.file.string(), counted(site.buses.size(), "bus")));
  }
  const hardware::HostPort at = hardware::parse_host_port(options.link.substr(4));
  return "sim:" + hardware::host_port_text({at.host, static_cast<std::uint16_t>(at.port + site.buses[bus].number)});
}

// Returns what the scene has for a cover.
const hardware::Scene& part_of(const hardware::RobotScene& scene, const robot::CoverConfig& cover) {
  const auto named = std::ranges::find(scene.names, cover.name);
  if (named == scene.names.end())
    throw InputError(fmt::format("{}: its robot {} has no cover {}; use a scene of this robot", scene.file.string(),
                                 scene.robot.string(), cover.name));
  const hardware::Scene& part = scene.parts[static_cast<std::size_t>(named - scene.names.begin())];
  if (part.design.design_id != cover.design.design_id)
    throw InputError(fmt::format(
        "{}: in its robot {} cover {} has design {:016x}, in the one given {:016x}; use a "
        "scene of this robot",
        scene.file.string(), scene.robot.string(), cover.name, part.design.design_id, cover.design.design_id));
  return part;
}

}  // namespace

hardware::RobotScene read_robot_scene(const std::filesystem::path& path) {
  return hardware::read_robot_scene(path, [](const std::filesystem::path& file) {
    const robot::Assembly assembly = robot::read_assembly(file);
    std::vector<hardware::RobotPart> parts;
    for (std::size_t c = 0; c < assembly.designs.size(); ++c)
      parts.push_back({assembly.robot.covers[c].name, assembly.designs[c]});
    return parts;
  });
}

hardware::JointScene scene_of(const robot::BusConfig& bus, const hardware::RobotScene* scene, bool switched,
                              std::optional<std::uint64_t> board_seed) {
  std::vector<hardware::SimulatedCover> covers;
  for (const robot::CoverConfig& c : bus.covers) {
    hardware::SimulatedCover cover{c.name, &c.design, {}, scene == nullptr ? nullptr : &part_of(*scene, c)};
    for (const std::string& serial : c.serials) cover.boards.push_back(session::to_unique_id(serial));
    covers.push_back(std::move(cover));
  }
  const std::uint64_t seed = scene == nullptr ? hardware::Scene{}.seed : scene->parts.front().seed;
  hardware::JointScene joint = hardware::join_covers(covers, bus.rates, board_seed_of(board_seed, seed));
  joint.scene.switched = joint.scene.switched || switched;
  return joint;
}

std::filesystem::path state_folder_of(const robot::Site& site, const robot::BusConfig& bus) {
  return hardware::state_folder() / ("robot_" + site.name) / bus.name;
}

std::unique_ptr<link::Link> open_bus(const robot::Site& site, std::size_t bus, const LinkOptions& options) {
  const robot::BusConfig& entry = site.buses.at(bus);
  if (!site.is_robot) return open_link(options, &entry.covers.front().design);
  LinkOptions own = options;
  own.link = link_of(site, bus, options);
  if (!link::is_in_process(own.link)) return open_link(own, nullptr);
  if (own.own_interrupts) catch_interrupts();
  std::optional<hardware::RobotScene> scene;
  if (!options.scene.empty()) scene = read_robot_scene(options.scene);
  hardware::JointScene joint = scene_of(entry, scene ? &*scene : nullptr, options.switched, options.board_seed);
  return simulate_here(own.link, std::move(joint.scene), state_folder_of(site, entry));
}

}  // namespace triskin::connect
