// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <span>
#include <string>

#include "command.hpp"
#include "triskin/connect/open_link.hpp"

namespace triskin::cli {

/// Adds --link and --scene to a command that talks to controllers. Without --link, the environment variable
/// TRISKIN_LINK names the link of a design; the links of a robot file take precedence over it.
inline void add_link_options(CLI::App& app, connect::LinkOptions& options) {
  connect::settle_link(options, false);
  const auto simulate = [&options](const std::string&) { connect::settle_link(options, true); };
  app.add_option("--link", options.link,
                 "where the controllers are, such as can:can0, usb or sim; see triskin help links")
      ->each([&options](const std::string&) { options.chosen = true; });
  app.add_flag("--switched", options.switched, "the link sim has switched modules (in a scene: the key \"hardware\")")
      ->each(simulate);
  app.add_option("--board-seed", options.board_seed,
                 "random seed of the serial numbers on the link sim (0: ascending; default: the scene's seed)")
      ->each(simulate);
  app.add_option("--scene", options.scene, "what the link sim simulates: contacts, faults, effects")->each(simulate);
}

/// Says in the first line, and in --json, that `link` is a simulation; says nothing for hardware.
inline void say_simulated(const link::Link& link, Output& output) {
  if (link::is_simulated(link.name())) output.mark_simulated();
}
inline void say_simulated(std::span<link::Link* const> links, Output& output) {
  for (const link::Link* link : links) say_simulated(*link, output);
}

}  // namespace triskin::cli
