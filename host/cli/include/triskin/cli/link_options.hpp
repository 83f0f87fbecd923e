// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/cli/command.hpp"
#include "triskin/connect/open_link.hpp"

namespace triskin::cli {

/// Adds --link and --scene, as all commands that talk to controllers have them.
inline void add_link_options(CLI::App& app, device::LinkOptions& options) {
  app.add_option("--link", options.link,
                 "sim, sim-usb, sim:HOST:PORT, can:IFACE, hid[:SERIAL] or usb[:SERIAL]; several real ones joined by "
                 "commas; with a robot file: those that it names, or sim, or sim:HOST:PORT for all of its buses")
      ->capture_default_str()
      ->each([&options](const std::string&) { options.chosen = true; });
  app.add_flag(
      "--switched", options.switched,
      "the link sim has switched modules, which the controller routes; a scene says it by its key \"hardware\"");
  app.add_option("--board-seed", options.board_seed,
                 "the link sim draws the serial numbers of its boards from this; 0: they ascend with the patches; "
                 "default: the scene's seed");
  app.add_option("--scene", options.scene, "what the link sim simulates: contacts, faults, effects (docs/scene.md)");
}

}  // namespace triskin::cli
