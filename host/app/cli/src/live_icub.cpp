// SPDX-License-Identifier: GPL-3.0-or-later
#include "live_icub.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>

#include "link_options.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/pace.hpp"
#include "triskin/skin/icub_skin.hpp"

namespace triskin::cli {
namespace {

constexpr std::uint64_t kIcubLine_us = 500'000;

std::string to_line(const wire::IcubTaxels& t) {
  const char* trouble = t.no_acknowledge ? "  no acknowledge" : t.out_of_range != 0 ? "  out of range" : "";
  return fmt::format("board {:2} triangle {:2}  {:3}{}", t.board, t.module, fmt::join(t.value, " "), trouble);
}

nlohmann::json report_boards(const skin::IcubSkin& skin, const Output& output) {
  nlohmann::json boards = nlohmann::json::array();
  for (const auto& b : skin.stream().boards()) {
    output.say(fmt::format("board {:2}  type {}  version {}.{} build {}", b.address, b.type, b.version_major,
                           b.version_minor, b.build));
    boards.push_back({{"address", b.address}, {"type", b.type}});
  }
  return boards;
}

void report_triangles(const skin::IcubSkin& skin, Output& output) {
  nlohmann::json triangles = nlohmann::json::array(), not_connected = nlohmann::json::array();
  for (const auto& [place, t] : skin.triangles()) {
    if (t.not_connected)
      not_connected.push_back({{"board", t.board}, {"triangle", t.module}});
    else
      triangles.push_back(
          {{"board", t.board}, {"triangle", t.module}, {"values", t.value}, {"no_acknowledge", t.no_acknowledge}});
  }
  if (!not_connected.empty())
    output.say(fmt::format("{} {} not connected: no module there, or a dead one",
                           counted(not_connected.size(), "triangle"), agreeing(not_connected.size(), "is", "are")));
  output.result["triangles"] = std::move(triangles);
  output.result["not_connected"] = std::move(not_connected);
}

}  // namespace

int live_icub(const connect::LinkOptions& link_options, const design::Design* design, double seconds, Output& output) {
  skin::IcubSkin skin(link_options, design);
  say_simulated(skin.link(), output);
  nlohmann::json boards = report_boards(skin, output);
  skin::LiveRun run;
  if (seconds > 0.0) run.until_us = skin.now_us() + static_cast<std::uint64_t>(seconds * 1e6);
  run.slice_us = kIcubLine_us;
  std::optional<Pace> pace;
  if (seconds == 0.0) pace.emplace(skin.now_us());
  run.after_slice = [&] {
    if (pace) pace->hold(skin.now_us());
    for (const auto& [place, taxels] : skin.triangles()) {
      if (!taxels.not_connected) output.say(to_line(taxels));
    }
    return true;
  };
  skin.run(run);
  output.result = {{"boards", std::move(boards)}, {"frames", skin.stream().frames()}, {"lost", skin.stream().lost()}};
  report_triangles(skin, output);
  if (!output.result["triangles"].empty()) return 0;
  output.say(skin.stream().boards().empty()
                 ? "no board answered; check the power and the cable"
                 : "no triangle sent a value; if the boards are Triskin's, run triskin flash first");
  return 1;
}

}  // namespace triskin::cli
