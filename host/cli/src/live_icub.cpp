// SPDX-License-Identifier: GPL-3.0-or-later
#include "live_icub.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>

#include "triskin/base/interrupt.hpp"
#include "triskin/cli/link_options.hpp"
#include "triskin/session/icub_stream.hpp"

namespace triskin::cli {
namespace {

constexpr std::uint64_t kIcubLine_us = 500'000;

std::string to_line(const wire::IcubTaxels& t) {
  const char* trouble = t.no_acknowledge ? "  no acknowledge" : t.out_of_range != 0 ? "  out of range" : "";
  return fmt::format("board {:2} triangle {:2}  {:3}{}", t.board, t.module, fmt::join(t.value, " "), trouble);
}

}  // namespace

int live_icub(const device::LinkOptions& link_options, const design::Design* design, double seconds, Output& output) {
  const auto link = device::open_link(link_options, design);
  say_simulated(*link, output);
  device::Bus bus(*link);
  std::map<std::pair<int, int>, wire::IcubTaxels> now;
  device::IcubStream stream(bus, [&](const wire::IcubTaxels& t) { now[{t.board, t.module}] = t; });
  nlohmann::json boards = nlohmann::json::array();
  for (const auto& b : stream.boards()) {
    output.say(fmt::format("board {:2}  type {}  version {}.{} build {}", b.address, b.type, b.version_major,
                           b.version_minor, b.build));
    boards.push_back({{"address", b.address}, {"type", b.type}});
  }
  const std::uint64_t start_us = bus.now_us(), end_us = start_us + static_cast<std::uint64_t>(seconds * 1e6);
  while ((seconds <= 0.0 || bus.now_us() < end_us) && !interrupt_request()) {
    const std::uint64_t next_us = bus.now_us() + kIcubLine_us;
    try {
      stream.run_until(seconds > 0.0 ? std::min(next_us, end_us) : next_us);
    } catch (const Cancelled&) {
      break;  // Ctrl-C is the usual end
    }
    for (const auto& [place, taxels] : now) {
      if (!taxels.not_connected) output.say(to_line(taxels));
    }
  }
  nlohmann::json triangles = nlohmann::json::array(), not_connected = nlohmann::json::array();
  for (const auto& [place, t] : now) {
    if (t.not_connected) {
      not_connected.push_back({{"board", t.board}, {"triangle", t.module}});
      continue;
    }
    triangles.push_back(
        {{"board", t.board}, {"triangle", t.module}, {"values", t.value}, {"no_acknowledge", t.no_acknowledge}});
  }
  if (!not_connected.empty())
    output.say(fmt::format("{} triangles are not connected: no module there, or a dead one", not_connected.size()));
  output.result = {{"boards", std::move(boards)},
                   {"frames", stream.frames()},
                   {"lost", stream.lost()},
                   {"triangles", std::move(triangles)},
                   {"not_connected", std::move(not_connected)}};
  return 0;
}

}  // namespace triskin::cli
