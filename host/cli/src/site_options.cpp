// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/cli/site_options.hpp"

#include "triskin/robot/bus_threads.hpp"

namespace triskin::cli {

void add_site_options(CLI::App& app, SiteOptions& options) {
  app.add_option("DESIGN", options.file, "design file, or robot file: all covers on all of its buses")->required();
  app.add_option("--cover", options.cover, "of a robot file: this cover alone");
  add_link_options(app, options.link);
}

OpenSite open_site(const SiteOptions& options, Output& output) {
  OpenSite open{robot::read_site(options.file), {}};
  robot::choose(open.site, options.cover);
  open.links = device::open_buses(open.site, options.link);
  say_simulated(open.links, output);
  return open;
}

const robot::CoverConfig& one_cover(const robot::Site& site, std::string_view command) {
  std::size_t covers = 0;
  const robot::CoverConfig* chosen = nullptr;
  for (const robot::BusConfig& bus : site.buses) {
    for (const robot::CoverConfig& c : bus.covers) {
      if (!c.chosen) continue;
      chosen = &c;
      ++covers;
    }
  }
  if (covers != 1 || site.buses.size() != 1)
    throw InputError(std::string(command) + " looks at one cover on one bus: say which with --cover");
  return *chosen;
}

void on_each_bus(OpenSite& open, const std::function<void(const robot::BusConfig&, device::Link&)>& work) {
  std::vector<std::string> names;
  for (const robot::BusConfig& bus : open.site.buses) names.push_back(bus.name);
  robot::on_each_bus(names, [&](std::size_t k) { work(open.site.buses[k], *open.links[k]); });
}

std::string prefix_of(const robot::CoverConfig& cover) {
  return cover.name.empty() ? "" : cover.name + ": ";
}

ProgressSink progress_of(const robot::BusConfig& bus, const robot::CoverConfig& cover, ProgressSink sink) {
  if (cover.name.empty() || !sink) return sink;
  constexpr int kPartsPerCover = 1 << 8;  // A bus has fewer controllers.
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
