// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "triskin/cli/link_options.hpp"
#include "triskin/connect/open_bus.hpp"
#include "triskin/robot/site.hpp"

namespace triskin::cli {

/// What a device command works on: a design file or a robot file, and the links.
struct SiteOptions {
  std::string file, cover;
  device::LinkOptions link;
};
/// Adds the file, --cover, --link and --scene.
void add_site_options(CLI::App& app, SiteOptions& options);

/// A site with its links open.
struct OpenSite {
  robot::Site site;
  std::vector<std::unique_ptr<device::Link>> links;  ///< indexed by bus
};
/// Reads the file, opens the links, and says where one is a simulation. Throws as robot::read_site and device::open_bus
/// do.
[[nodiscard]] OpenSite open_site(const SiteOptions& options, Output& output);

/// The one cover that is chosen of a site with one bus. Throws InputError naming `command` where there are several.
[[nodiscard]] const robot::CoverConfig& one_cover(const robot::Site& site, std::string_view command);

/// Runs `work` for each bus, side by side. Throws as robot::on_each_bus does.
void on_each_bus(OpenSite& open, const std::function<void(const robot::BusConfig& bus, device::Link& link)>& work);

/// "COVER: " before what is said of a cover of a robot; nothing for a design file.
[[nodiscard]] std::string prefix_of(const robot::CoverConfig& cover);

/// Progress of one cover of a robot: with its name, and parts of its own. `sink` as it is for a design file.
[[nodiscard]] ProgressSink progress_of(const robot::BusConfig& bus, const robot::CoverConfig& cover, ProgressSink sink);

/// Keys "cover" and "bus" for the report of a cover; an empty object for a design file.
[[nodiscard]] nlohmann::json keys_of(const robot::BusConfig& bus, const robot::CoverConfig& cover);

}  // namespace triskin::cli
