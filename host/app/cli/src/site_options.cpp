// SPDX-License-Identifier: GPL-3.0-or-later
#include "site_options.hpp"

namespace triskin::cli {

void add_site_options(CLI::App& app, SiteOptions& options) {
  app.add_option("DESIGN", options.file, "design file, or robot file: all covers on all of its buses")->required();
  app.add_option("--cover", options.cover, "robot file: only this cover");
  add_link_options(app, options.link);
}

robot::Site read_site(const SiteOptions& options) {
  robot::Site site = robot::read_site(options.file);
  robot::choose(site, options.cover);
  return site;
}

void open_links(skin::LiveSkin& skin, Output& output) {
  skin.open();
  say_simulated(skin.links(), output);
}

skin::LiveSkin open_skin(const SiteOptions& options, Output& output) {
  skin::LiveSkin skin(read_site(options), options.link);
  open_links(skin, output);
  return skin;
}

std::string OpenBus::prefix() const {
  return config == nullptr || config->name.empty() ? "" : config->name + ": ";
}

Answering find_controllers(const OpenBus& at, int only_node) {
  constexpr int kAttempts = 3;
  Answering found;
  for (int attempt = 0; attempt < kAttempts && (attempt == 0 || !found.missing.empty()); ++attempt) {
    found = {at.bus.discover(), {}};
    if (only_node != 0)
      std::erase_if(found.claims, [&](const wire::NodeClaim& c) { return c.node_address != only_node; });
    if (at.config == nullptr || only_node != 0) continue;
    for (const robot::CoverConfig& cover : at.config->covers) {
      for (const layout::PatchIndex patch : design::patches_here(cover.design)) {
        const int node = static_cast<int>(design::node_address_of(cover.design, patch));
        if (std::ranges::find(found.claims, node, &wire::NodeClaim::node_address) == found.claims.end())
          found.missing.push_back(fmt::format("{}patch {} (node address {})", prefix_of(cover), patch, node));
      }
    }
  }
  return found;
}

void on_each_bus(const SiteOptions& options, Output& output, const std::function<void(const OpenBus&)>& work) {
  if (options.file.empty()) {
    const auto link = connect::open_link(options.link, nullptr);
    say_simulated(*link, output);
    session::Bus bus(*link);
    return work({*link, bus});
  }
  skin::LiveSkin skin = open_skin(options, output);
  skin.on_each_bus([&](skin::LiveBus& live) { work({live.link(), live.bus(), &live.config()}); });
}

skin::LiveCover& one_cover(const skin::LiveSkin& skin, std::string_view command) {
  if (skin.buses().size() != 1 || skin.buses().front()->covers().size() != 1)
    throw InputError(std::string(command) + " needs one cover on one bus; choose it with --cover");
  return skin.buses().front()->covers().front();
}

std::string prefix_of(const robot::CoverConfig& cover) {
  return cover.name.empty() ? "" : cover.name + ": ";
}

ProgressSink progress_of(const robot::BusConfig& bus, const robot::CoverConfig& cover, ProgressSink sink) {
  if (cover.name.empty() || !sink) return sink;
  constexpr int kPartsPerCover = 1 << 8;  // Every bus has fewer controllers than this.
  constexpr int kPartsPerBus = kPartsPerCover << 8;
  const int first = bus.number * kPartsPerBus + cover.cover * kPartsPerCover;
  return [first, name = cover.name, sink = std::move(sink)](const Progress& p) {
    sink({p.stage, p.fraction, p.detail.empty() ? name : name + ", " + p.detail, p.part < 0 ? -1 : first + p.part});
  };
}

nlohmann::json keys_of(const robot::BusConfig& bus, const robot::CoverConfig& cover) {
  if (cover.name.empty()) return nlohmann::json::object();
  return {{"cover", cover.name}, {"bus", bus.name}};
}

}  // namespace triskin::cli
