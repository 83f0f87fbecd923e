// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/connect/open_bus.hpp"

#include <fmt/format.h>

#include "triskin/base/counted.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/link/link_kind.hpp"
#include "triskin/scene/tcp_link.hpp"
#include "triskin/scene/virtual_skin.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::device {
namespace {

std::string link_of(const robot::Site& site, std::size_t bus, const LinkOptions& options) {
  if (!options.chosen) return site.buses[bus].link;
  if (!options.link.starts_with("sim:")) {
    if (options.link == kSimulatedBus) return is_usb(site.buses[bus].link) ? kSimulatedHub : kSimulatedBus;
    if (options.link == kSimulatedHub || site.buses.size() == 1) return options.link;
    throw InputError(fmt::format(
        "--link {}: {} has {}; its file names their links, only sim or sim:HOST:PORT can stand for all of them",
        options.link, site.file.string(), counted(site.buses.size(), "bus")));
  }
  const HostPort at = parse_host_port(options.link.substr(4));
  return "sim:" + host_port_text({at.host, static_cast<std::uint16_t>(at.port + site.buses[bus].number)});
}

}  // namespace

scene::Scene scene_of(const robot::BusConfig& bus, bool switched, std::optional<std::uint64_t> board_seed) {
  std::vector<scene::SimulatedCover> covers;
  for (const robot::CoverConfig& c : bus.covers) {
    scene::SimulatedCover cover{c.name, &c.design, {}};
    for (const std::string& serial : c.serials) cover.boards.push_back(to_unique_id(serial));
    covers.push_back(std::move(cover));
  }
  scene::Scene scene = scene::join_covers(covers, bus.rates, board_seed_of(board_seed, scene::Scene{}.seed)).scene;
  scene.switched = switched;
  return scene;
}

std::filesystem::path state_folder_of(const robot::Site& site, const robot::BusConfig& bus) {
  return scene::state_folder() / ("robot_" + site.name) / bus.name;
}

std::unique_ptr<Link> open_bus(const robot::Site& site, std::size_t bus, const LinkOptions& options) {
  const robot::BusConfig& entry = site.buses.at(bus);
  if (!site.is_robot) return open_link(options, &entry.covers.front().design);
  if (!options.scene.empty()) throw InputError("--scene is for a design file; a robot is simulated untouched");
  LinkOptions own = options;
  own.link = link_of(site, bus, options);
  if (!is_in_process(own.link)) return open_link(own, nullptr);
  if (own.own_interrupts) catch_interrupts();
  return simulate_here(own.link, scene_of(entry, options.switched, options.board_seed), state_folder_of(site, entry));
}

}  // namespace triskin::device
