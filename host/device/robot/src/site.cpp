// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/robot/site.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/wire/sampling.hpp"

namespace triskin::robot {
namespace {

Site design_site(const std::filesystem::path& path) {
  CoverConfig cover{"", path, design::read_intact_design(path), {}, 0, 0, true};
  cover.serials.resize(cover.design.patches.size());
  Site site{path, cover.design.name, false, {}};
  site.buses.emplace_back();
  site.buses.back().covers.push_back(std::move(cover));
  return site;
}

void require_sound(const Assembly& a) {
  constexpr std::size_t kMaxShown = 5;
  const std::vector<Problem> problems = check(a);
  if (problems.empty()) return;
  std::string text = fmt::format("{}: {}", a.file.string(), counted(problems.size(), "problem"));
  for (std::size_t k = 0; k < std::min(kMaxShown, problems.size()); ++k)
    text += fmt::format("\n  {}: {}; {}", problems[k].place, problems[k].text, problems[k].remedy);
  if (problems.size() > kMaxShown) text += fmt::format("\n  … triskin robot show {} lists all", a.file.string());
  throw InputError(text);
}

// Returns nothing if no part of this cover is on the bus.
std::optional<CoverConfig> on_bus(const Assembly& a, std::size_t index, int bus) {
  const CoverEntry& entry = a.robot.covers[index];
  CoverConfig cover{entry.name, a.file.parent_path() / entry.design, a.designs[index], {}, static_cast<int>(index), 0,
                    true};
  cover.design.name = entry.name;
  cover.design.node_addresses.assign(cover.design.patches.size(), 0);
  cover.serials.resize(cover.design.patches.size());
  bool any = false;
  for (const ControllerEntry& e : entry.controllers) {
    if (bus_of(a.robot, entry, e) != bus) continue;
    any = true;
    cover.design.node_addresses.at(static_cast<std::size_t>(e.patch)) = static_cast<std::uint8_t>(e.node);
    cover.serials.at(static_cast<std::size_t>(e.patch)) = e.serial;
  }
  return any ? std::optional(std::move(cover)) : std::nullopt;
}

void append(BusConfig& bus, CoverConfig cover) {
  if (!bus.covers.empty())
    cover.first_module =
        bus.covers.back().first_module + static_cast<int>(bus.covers.back().design.layout.modules.size());
  bus.covers.push_back(std::move(cover));
}

// A bus has one rate: that of the cover that wants most. If a cover leaves it open, no rate is chosen.
int every_for(const Assembly& a, const BusConfig& bus) {
  double wanted_hz = 0.0;
  for (const CoverConfig& c : bus.covers) {
    const double rate_hz = a.robot.covers[static_cast<std::size_t>(c.cover)].rate_hz;
    if (rate_hz <= 0.0) return 0;
    wanted_hz = std::max(wanted_hz, rate_hz);
  }
  const double full_hz = 1e6 / wire::sequence_us(wire::Decimation::k256);
  return bus.covers.empty() ? 0 : std::clamp(static_cast<int>(std::floor(full_hz / wanted_hz)), 1, 255);
}

}  // namespace

Site site_of(const Assembly& a) {
  require_sound(a);
  Site site{a.file, a.robot.name, true, {}};
  for (std::size_t b = 0; b < a.robot.buses.size(); ++b) {
    const BusEntry& entry = a.robot.buses[b];
    BusConfig bus{static_cast<int>(site.buses.size()), entry.name, entry.link, entry.rates, 0, {}};
    for (std::size_t c = 0; c < a.robot.covers.size(); ++c) {
      if (auto cover = on_bus(a, c, static_cast<int>(b))) append(bus, std::move(*cover));
    }
    bus.every = every_for(a, bus);
    if (!bus.covers.empty()) site.buses.push_back(std::move(bus));
  }
  if (site.buses.empty())
    throw InputError(fmt::format("{}: no cover hangs on a bus; add one with triskin robot add", a.file.string()));
  return site;
}

Site read_site(const std::filesystem::path& path) {
  return is_robot_file(path) ? site_of(read_assembly(path)) : design_site(path);
}

void choose(Site& site, const std::string& name) {
  if (name.empty()) return;
  std::set<std::string> names;
  for (BusConfig& bus : site.buses) {
    for (CoverConfig& cover : bus.covers) {
      names.insert(cover.name);
      cover.chosen = cover.name == name;
    }
  }
  if (!names.contains(name))
    throw InputError(
        site.is_robot
            ? fmt::format("--cover {}: {} has {}", name, site.file.string(), fmt::join(names, ", "))
            : fmt::format("--cover {}: {} is a design file; only a robot file has covers", name, site.file.string()));
  std::erase_if(site.buses,
                [](const BusConfig& bus) { return std::ranges::none_of(bus.covers, &CoverConfig::chosen); });
}

deploy::FlashOptions flash_options(const BusConfig& bus, const CoverConfig& cover, deploy::FlashOptions options) {
  for (const layout::PatchIndex patch : design::patches_here(cover.design)) {
    const std::string& serial = cover.serials[static_cast<std::size_t>(patch)];
    const bool named = std::ranges::any_of(options.assign, [&](const auto& a) { return a.patch == patch; });
    if (!serial.empty() && !named) options.assign.push_back({patch, serial});
  }
  for (const CoverConfig& other : bus.covers) {
    if (&other == &cover) continue;
    for (const layout::PatchIndex patch : design::patches_here(other.design))
      options.neighbours.push_back({design::node_address_of(other.design, patch), other.design.design_id,
                                    other.serials[static_cast<std::size_t>(patch)], &other.design, patch});
  }
  return options;
}

std::vector<session::StreamDemand> other_demands(const BusConfig& bus,
                                                 std::span<const design::Design* const> streamed) {
  std::vector<session::StreamDemand> demands;
  for (const CoverConfig& cover : bus.covers) {
    if (std::ranges::find(streamed, &cover.design) != streamed.end()) continue;
    for (const layout::PatchIndex patch : design::patches_here(cover.design))
      demands.push_back({static_cast<std::uint8_t>(design::node_address_of(cover.design, patch)),
                         cover.design.patches[static_cast<std::size_t>(patch)].modules.size(), 0});
  }
  return demands;
}

session::StreamOptions stream_options(const BusConfig& bus, std::span<const design::Design* const> streamed,
                                      session::StreamOptions options) {
  options.neighbours = other_demands(bus, streamed);
  if (options.every == 0) options.every = bus.every;
  return options;
}

design::SideBySide in_base(const Assembly& a) {
  std::vector<design::PlacedCover> placed;
  std::vector<design::Design> named = a.designs;
  for (std::size_t c = 0; c < named.size(); ++c) {
    const CoverEntry& entry = a.robot.covers[c];
    named[c].name = entry.name;
    named[c].node_addresses.assign(named[c].patches.size(), 0);
    for (const ControllerEntry& e : entry.controllers)
      named[c].node_addresses.at(static_cast<std::size_t>(e.patch)) = static_cast<std::uint8_t>(e.node);
    const bool known = a.frames && a.frames->has(entry.frame);
    placed.push_back({&named[c], known ? a.frames->pose(entry.frame) * entry.pose : entry.pose});
  }
  design::SideBySide joint = design::side_by_side(placed);
  joint.design.name = a.robot.name;
  return joint;
}

}  // namespace triskin::robot
