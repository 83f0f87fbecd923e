// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/robot/edit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <set>

#include "triskin/base/error.hpp"

namespace triskin::robot {
namespace {

// Returns the node addresses in use on a bus; `besides` counts with its own entries, even if it is not in `robot` yet.
std::set<int> nodes_on(const Robot& robot, int bus, const CoverEntry& besides) {
  std::set<int> nodes;
  for (const CoverEntry& cover : robot.covers) {
    if (&cover == &besides) continue;
    for (const ControllerEntry& e : cover.controllers) {
      if (bus_of(robot, cover, e) == bus) nodes.insert(e.node);
    }
  }
  for (const ControllerEntry& e : besides.controllers) {
    if (bus_of(robot, besides, e) == bus) nodes.insert(e.node);
  }
  return nodes;
}

int free_node(const Robot& robot, const CoverEntry& cover, int first_node) {
  const int index = bus_of(robot, cover, {});
  if (index < 0) throw InputError(fmt::format("cover {}: there is no bus \"{}\"; add it first", cover.name, cover.bus));
  const BusEntry& bus = robot.buses[static_cast<std::size_t>(index)];
  const std::set<int> taken = nodes_on(robot, index, cover);
  for (int node = std::max(bus.first_node, first_node); node <= bus.last_node; ++node) {
    if (!taken.contains(node)) return node;
  }
  throw InputError(
      fmt::format("cover {}: bus {} has no free node address in {} … {}; widen its range or use another bus",
                  cover.name, bus.name, std::max(bus.first_node, first_node), bus.last_node));
}

std::uint32_t rate_in(const std::string& text, const std::string& whole) {
  std::uint32_t rate = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), rate);
  if (error != std::errc{} || end != text.data() + text.size() || rate < 10'000 || rate > 10'000'000)
    throw InputError(fmt::format("bus {}: \"{}\" is no bit rate of 10000 … 10000000 bit/s", whole, text));
  return rate;
}

}  // namespace

void seat(Robot& robot, CoverEntry& cover, const design::Design& design, int first_node) {
  std::erase_if(cover.controllers, [&](const ControllerEntry& e) { return !design::has_patch(design, e.patch); });
  for (const layout::PatchIndex patch : design::patches_of(design)) {
    if (std::ranges::find(cover.controllers, patch, &ControllerEntry::patch) != cover.controllers.end()) continue;
    ControllerEntry entry;
    entry.patch = patch;
    entry.node = layout::NodeAddress{free_node(robot, cover, first_node)};
    cover.controllers.push_back(entry);
  }
  std::ranges::sort(cover.controllers, {}, &ControllerEntry::patch);
  cover.design_id = design.design_id;
}

CoverEntry* find_cover(Robot& robot, const std::string& name) {
  const auto found = std::ranges::find(robot.covers, name, &CoverEntry::name);
  return found == robot.covers.end() ? nullptr : &*found;
}

BusEntry parse_bus(const std::string& text) {
  const std::size_t equals = text.find('='), at = text.rfind('@');
  BusEntry bus;
  bus.name = text.substr(0, equals);
  if (equals == std::string::npos || equals + 1 == text.size() || !is_name(bus.name))
    throw InputError(
        fmt::format("bus \"{}\": give NAME=LINK, for example left=can:can0, or NAME=LINK@1000000/2000000", text));
  bus.link = text.substr(equals + 1, at == std::string::npos ? at : at - equals - 1);
  if (at == std::string::npos) return bus;
  const std::string rates = text.substr(at + 1);
  const std::size_t slash = rates.find('/');
  bus.rates.nominal = rate_in(rates.substr(0, slash), text);
  bus.rates.data = slash == std::string::npos ? bus.rates.nominal : rate_in(rates.substr(slash + 1), text);
  return bus;
}

}  // namespace triskin::robot
