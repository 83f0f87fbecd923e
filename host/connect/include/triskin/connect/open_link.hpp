// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "triskin/design/design.hpp"
#include "triskin/link/link.hpp"
#include "triskin/link/link_kind.hpp"
#include "triskin/scene/scene.hpp"

namespace triskin::device {

/// Values of `--link` and `--scene`.
struct LinkOptions {
  std::string link;     ///< It is empty if none was named, which only a robot file makes up for.
  bool chosen = false;  ///< `link` takes precedence over what a robot file says.
  std::string scene;    ///< It is the scene file for `sim`; if it is empty, the design is simulated with nothing wrong.
  bool switched = false;  ///< `sim` without a scene file has switched modules.
  /// Seed of the serial numbers of simulated boards: 0: they ascend with the patches; empty: the scene's seed. Boards
  /// of a robot file are numbered by it.
  std::optional<std::uint64_t> board_seed{};
  bool own_interrupts = true;  ///< It uses catch_interrupts(); if false, signals are left to the caller.
};

/// Sets the link of options that have none `chosen`: the simulation where something was asked for that only a
/// simulation has (`simulates`), else what the environment variable TRISKIN_LINK names, else none.
void settle_link(LinkOptions& options, bool simulates);

/// Scene::board_seed for what LinkOptions::board_seed asks: 0 is none, nothing asked is `by_default`.
[[nodiscard]] std::optional<std::uint64_t> board_seed_of(std::optional<std::uint64_t> asked, std::uint64_t by_default);

/// The simulation of `scene` behind a link that is_in_process(); `folder` keeps the flash of its controllers, empty:
/// memory. Throws as scene::VirtualSkin does.
[[nodiscard]] std::unique_ptr<Link> simulate_here(const std::string& link, scene::Scene scene,
                                                  const std::filesystem::path& folder);

/// Throws InputError where no link is named; it lists what is attached to this computer.
void require_link(const LinkOptions& options);

/// Opens `sim`, `sim-usb`, `sim:HOST:PORT`, `can:IFACE`, `hid[:SERIAL]` or `usb[:SERIAL]`, or several of the last
/// three, joined by commas. `design` is what `sim` simulates when there is no scene; null where a command has none; not
/// kept. From now on Ctrl-C only sets interrupt_request(), unless the options leave signals to the caller. Throws
/// InputError (no link or an unknown one, no design or scene for `sim`, a scene of another design), DeviceError (cannot
/// connect).
[[nodiscard]] std::unique_ptr<Link> open_link(const LinkOptions& options, const design::Design* design);

}  // namespace triskin::device
