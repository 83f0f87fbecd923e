// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "link_options.hpp"
#include "triskin/robot/site.hpp"
#include "triskin/skin/live_skin.hpp"
#include "triskin/wire/node_claim.hpp"

namespace triskin::cli {

/// A device command works on a design file or a robot file, over its links.
struct SiteOptions {
  std::string file, cover;
  connect::LinkOptions link;
};
/// Adds the file, --cover, --link and --scene.
void add_site_options(CLI::App& app, SiteOptions& options);

/// Reads the file and chooses the cover. Throws as robot::read_site and robot::choose do.
[[nodiscard]] robot::Site read_site(const SiteOptions& options);
/// Opens the links and says which of them are simulations. Throws as connect::open_bus does.
void open_links(skin::LiveSkin& skin, Output& output);
/// An open bus, whatever is on it.
struct OpenBus {
  link::Link& link;
  session::Bus& bus;
  const robot::BusConfig* config = nullptr;  ///< null if no file says what is on the bus

  /// "BUS: " as a prefix for messages about a bus of a robot; empty otherwise.
  [[nodiscard]] std::string prefix() const;
};
/// Opens the links of the file, or only --link if no file was given, and runs `work` for all buses in parallel. Throws
/// as read_site and open_links.
void on_each_bus(const SiteOptions& options, Output& output, const std::function<void(const OpenBus&)>& work);
/// The controllers that answer on a bus.
struct Answering {
  std::vector<wire::NodeClaim> claims;
  std::vector<std::string> missing;  ///< in the file, silent although asked again: "patch 1 (node address 2)"
};
/// Asks who is on the bus, and again while somebody is missing whom the file expects there. With a node address in
/// `only_node` the others do not count.
[[nodiscard]] Answering find_controllers(const OpenBus& at, int only_node = 0);
/// Reads the file and opens the links.
[[nodiscard]] skin::LiveSkin open_skin(const SiteOptions& options, Output& output);

/// Returns the chosen cover of a site with one bus. Throws InputError naming `command` if there are several.
[[nodiscard]] skin::LiveCover& one_cover(const skin::LiveSkin& skin, std::string_view command);

/// Returns "COVER: " as a prefix for messages about a cover of a robot; empty for a design file.
[[nodiscard]] std::string prefix_of(const robot::CoverConfig& cover);

/// Returns a sink for the progress of one cover of a robot, with its name and its own parts; for a design file it is
/// `sink` itself.
[[nodiscard]] ProgressSink progress_of(const robot::BusConfig& bus, const robot::CoverConfig& cover, ProgressSink sink);

/// Returns the keys "cover" and "bus" for the report of a cover; an empty object for a design file.
[[nodiscard]] nlohmann::json keys_of(const robot::BusConfig& bus, const robot::CoverConfig& cover);

}  // namespace triskin::cli
