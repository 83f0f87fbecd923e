// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdlib>
#include <memory>
#include <span>
#include <string>

#include "triskin/cli/command.hpp"
#include "triskin/connect/open_link.hpp"

namespace triskin::cli {

/// What is known of a simulation makes the link `sim` where --link names no other: who gives it asks for a simulation.
inline void imply_simulation(device::LinkOptions& options) {
  if (!options.chosen) options.link = device::kSimulatedBus;
}

/// Adds --link and --scene, as all commands that talk to controllers have them. Without --link the environment variable
/// TRISKIN_LINK names the link of a design; the links of a robot file go before it.
inline void add_link_options(CLI::App& app, device::LinkOptions& options) {
  if (const char* named = std::getenv("TRISKIN_LINK")) options.link = named;
  app.add_option("--link", options.link,
                 "sim, sim-usb, sim:HOST:PORT, can:IFACE, hid[:SERIAL] or usb[:SERIAL]; several real ones joined by "
                 "commas; with a robot file: those that it names, or sim, or sim:HOST:PORT for all of its buses; "
                 "default: the environment variable "
                 "TRISKIN_LINK")
      ->each([&options](const std::string&) { options.chosen = true; });
  app.add_flag(
         "--switched", options.switched,
         "the link sim has switched modules, which the controller routes; a scene says it by its key \"hardware\"")
      ->each([&options](const std::string&) { imply_simulation(options); });
  app.add_option("--board-seed", options.board_seed,
                 "the link sim draws the serial numbers of its boards from this; 0: they ascend with the patches; "
                 "default: the scene's seed")
      ->each([&options](const std::string&) { imply_simulation(options); });
  app.add_option("--scene", options.scene, "what the link sim simulates: contacts, faults, effects (docs/scene.md)")
      ->each([&options](const std::string&) { imply_simulation(options); });
}

/// Says with the first line, and in --json, that `link` is a simulation; nothing where it is hardware.
inline void say_simulated(const device::Link& link, Output& output) {
  if (device::is_simulated(link.name())) output.mark_simulated(link.name());
}
inline void say_simulated(std::span<const std::unique_ptr<device::Link>> links, Output& output) {
  for (const auto& link : links) say_simulated(*link, output);
}

}  // namespace triskin::cli
