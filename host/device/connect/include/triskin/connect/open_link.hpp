// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "triskin/design/design.hpp"
#include "triskin/hardware/scene.hpp"
#include "triskin/link/link.hpp"
#include "triskin/link/link_kind.hpp"

namespace triskin::connect {

/// The options are the values of `--link` and `--scene`.
struct LinkOptions {
  std::string link;       ///< An empty text means that no link was named; then a robot file must name one.
  bool chosen = false;    ///< True means that `link` takes precedence over the robot file.
  std::string scene;      ///< The scene file is for `sim`; if it is empty, the design is simulated without faults.
  bool switched = false;  ///< Without a scene file, `sim` then has switched modules.
  /// The seed determines the serial numbers of simulated boards. With 0 they ascend with the patches; if empty, the
  /// scene's seed is used. Boards of a robot file are numbered by the seed.
  std::optional<std::uint64_t> board_seed{};
  bool own_interrupts = true;  ///< True means that catch_interrupts() is used; false leaves signals to the caller.
};

/// Sets the link if none is `chosen`: the simulation if the user asked for something that only a simulation has
/// (`simulates`), else the link in the environment variable TRISKIN_LINK, else none.
void settle_link(LinkOptions& options, bool simulates);

/// Converts LinkOptions::board_seed to Scene::board_seed: 0 becomes none, and an empty value becomes `by_default`.
[[nodiscard]] std::optional<std::uint64_t> board_seed_of(std::optional<std::uint64_t> asked, std::uint64_t by_default);

/// Simulates `scene` behind a link that is_in_process(). `folder` stores the flash of its controllers; if it is empty,
/// memory does. Throws as hardware::VirtualSkin does.
[[nodiscard]] std::unique_ptr<link::Link> simulate_here(const std::string& link, hardware::Scene scene,
                                                        const std::filesystem::path& folder);

/// Throws InputError if no link is named; the message lists the devices attached to this computer.
void require_link(const LinkOptions& options);

/// Throws InputError if `link` has no form that open_link() knows. It opens nothing.
void require_known_link(const std::string& link);

/// Opens `sim`, `sim-usb`, `sim:HOST:PORT`, `can:IFACE`, `hid[:SERIAL]` or `usb[:SERIAL]`, or several of the last
/// three, joined by commas. `sim` simulates `design` when there is no scene; null for commands without a design; the
/// pointer is not kept. From now on Ctrl-C only sets interrupt_request(), unless the options leave signals to the
/// caller. Throws InputError (no link or an unknown one, no design or scene for `sim`, a scene of another design),
/// DeviceError (cannot connect).
[[nodiscard]] std::unique_ptr<link::Link> open_link(const LinkOptions& options, const design::Design* design);

}  // namespace triskin::connect
