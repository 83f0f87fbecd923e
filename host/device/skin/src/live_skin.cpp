// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/skin/live_skin.hpp"

#include <utility>

#include "triskin/robot/bus_threads.hpp"

namespace triskin::skin {

LiveSkin::LiveSkin(robot::Site site, const connect::LinkOptions& link)
    : site_(std::make_unique<const robot::Site>(std::move(site))) {
  for (std::size_t b = 0; b < site_->buses.size(); ++b) buses_.push_back(std::make_unique<LiveBus>(*site_, b, link));
}

void LiveSkin::open() {
  for (const auto& bus : buses_) bus->open();
}

std::vector<link::Link*> LiveSkin::links() const {
  std::vector<link::Link*> links;
  for (const auto& bus : buses_) links.push_back(&bus->link());
  return links;
}

void LiveSkin::on_each_bus(const std::function<void(LiveBus&)>& work) {
  std::vector<std::string> names;
  for (const auto& bus : buses_) names.push_back(bus->config().name);
  robot::on_each_bus(names, [&](std::size_t b) { work(*buses_[b]); });
}

}  // namespace triskin::skin
