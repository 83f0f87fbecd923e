// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

#include "triskin/cli/link_options.hpp"
#include "triskin/robot/site.hpp"
#include "triskin/skin/live_skin.hpp"

namespace triskin::cli {

/// What a device command works on: a design file or a robot file, and the links.
struct SiteOptions {
  std::string file, cover;
  device::LinkOptions link;
};
/// Adds the file, --cover, --link and --scene.
void add_site_options(CLI::App& app, SiteOptions& options);

/// Reads the file and chooses the cover. Throws as robot::read_site and robot::choose do.
[[nodiscard]] robot::Site read_site(const SiteOptions& options);
/// Opens the links, and says where one is a simulation. Throws as device::open_bus does.
void open_links(device::LiveSkin& skin, Output& output);
/// Both.
[[nodiscard]] device::LiveSkin open_skin(const SiteOptions& options, Output& output);

/// The one cover that is chosen of a site with one bus. Throws InputError naming `command` where there are several.
[[nodiscard]] device::LiveCover& one_cover(const device::LiveSkin& skin, std::string_view command);

/// "COVER: " before what is said of a cover of a robot; nothing for a design file.
[[nodiscard]] std::string prefix_of(const robot::CoverConfig& cover);

/// Progress of one cover of a robot: with its name, and parts of its own. `sink` as it is for a design file.
[[nodiscard]] ProgressSink progress_of(const robot::BusConfig& bus, const robot::CoverConfig& cover, ProgressSink sink);

/// Keys "cover" and "bus" for the report of a cover; an empty object for a design file.
[[nodiscard]] nlohmann::json keys_of(const robot::BusConfig& bus, const robot::CoverConfig& cover);

}  // namespace triskin::cli
