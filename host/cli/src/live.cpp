// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "live_icub.hpp"
#include "offset_lines.hpp"
#include "triskin/cli/link_options.hpp"
#include "triskin/host/interrupt.hpp"
#include "triskin/jobs/touch_map.hpp"
#include "triskin/layout/module.hpp"

namespace triskin::cli {
namespace {

constexpr int kWalk = -2, kNobody = -1;

struct Options {
  std::string design;
  std::string protocol = "triskin";
  device::LinkOptions link;
  double seconds = 0.0;
  int press = kWalk;  // module, kNobody, or kWalk
  int taxel = -1;
};

constexpr std::uint64_t kLine_us = 200'000;
constexpr std::uint64_t kRest_us = 150'000;
constexpr std::uint64_t kFingerMoves_us = 2'000'000;

nlohmann::json to_json(const device::PressedTaxel& t) {
  return {{"module", t.module},
          {"taxel", t.taxel},
          {"change_counts", t.change_counts},
          {"position_mm", {t.position_mm.x(), t.position_mm.y(), t.position_mm.z()}},
          {"normal", {t.normal.x(), t.normal.y(), t.normal.z()}}};
}

std::string to_line(const device::PressedTaxel& t, double time_s, std::size_t others) {
  const auto bar = std::string(static_cast<std::size_t>(std::clamp(t.change_counts / 500.0, 1.0, 24.0)), '#');
  return fmt::format("{:7.2f} s  module {:4} taxel {:2}  at ({:8.2f}, {:8.2f}, {:8.2f}) mm  {:6.0f} {:<24} +{} taxels",
                     time_s, t.module, t.taxel, t.position_mm.x(), t.position_mm.y(), t.position_mm.z(),
                     t.change_counts, bar, others);
}

// On a simulated link without a scene nobody would touch the skin: the virtual finger tips on one taxel after another.
class Demonstrator {
 public:
  Demonstrator(device::Link& link, const Options& options, int modules)
      : finger_(options.link.scene.empty() || options.press >= 0 ? link.finger() : nullptr),
        options_(options),
        modules_(modules) {}
  void step(std::uint64_t elapsed_us) {
    if (finger_ == nullptr || modules_ == 0 || options_.press == kNobody || elapsed_us < kRest_us) return;
    const int turn = static_cast<int>(elapsed_us / kFingerMoves_us);
    if (turn == turn_ || (turn_ >= 0 && options_.press >= 0)) return;
    turn_ = turn;
    const int module = options_.press >= 0 ? options_.press : turn % modules_;
    finger_->press(module, options_.press >= 0 ? options_.taxel
                                               : kTaxelsInTurn[static_cast<std::size_t>(turn) % kTaxelsInTurn.size()]);
  }

 private:
  static constexpr std::array<int, layout::kPressureTaxelsPerModule> kTaxelsInTurn{3, 9, 1, 5, 0, 7, 2, 4, 8, 11};
  static_assert(std::ranges::all_of(kTaxelsInTurn,
                                    [](int t) { return layout::measures_pressure(static_cast<std::size_t>(t)); }));
  device::Finger* finger_;
  const Options& options_;
  int modules_;
  int turn_ = -1;
};

int run_icub(const Options& options, Output& output) {
  std::optional<design::Design> design;  // only the simulation needs one
  if (!options.design.empty()) design = design::read_intact_design(options.design);
  return live_icub(options.link, design ? &*design : nullptr, options.seconds, output);
}

int run(const Options& options, Output& output) {
  if (options.protocol == "icub") return run_icub(options, output);
  if (options.design.empty()) throw InputError("live: give the design file; only --protocol icub works without");
  const design::Design design = design::read_intact_design(options.design);
  const int modules = static_cast<int>(design.layout.modules.size());
  if (options.press >= modules)
    throw InputError(fmt::format("--press {}: the design has modules 0 … {}", options.press, modules - 1));
  const auto link = device::open_link(options.link, &design);
  device::Bus bus(*link);
  nlohmann::json offsets = say_offsets(bus, design, output);
  device::TouchMap map(design);
  device::Stream stream(bus, design, [&](const device::ModuleFrame& f) { map.add(f); });
  Demonstrator demonstrator(*link, options, modules);
  const std::uint64_t start_us = bus.now_us();
  const auto end_us = static_cast<std::uint64_t>(options.seconds * 1e6);
  std::vector<device::PressedTaxel> pressed;
  while ((options.seconds <= 0.0 || bus.now_us() - start_us < end_us) && !interrupt_request()) {
    demonstrator.step(bus.now_us() - start_us);
    const std::uint64_t next_us = bus.now_us() + kLine_us;
    try {
      stream.run_until(options.seconds > 0.0 ? std::min(next_us, start_us + end_us) : next_us);
    } catch (const Cancelled&) {
      break;  // Ctrl-C is the usual end
    }
    const auto now = map.pressed();
    if (!now.empty()) {
      pressed = now;
      output.say(to_line(now.front(), static_cast<double>(bus.now_us() - start_us) * 1e-6, now.size() - 1));
    }
  }
  nlohmann::json list = nlohmann::json::array();
  for (const auto& t : pressed) list.push_back(to_json(t));
  output.result = {{"frames", stream.frames()},
                   {"lost", stream.lost()},
                   {"pressed", std::move(list)},
                   {"offsets", std::move(offsets)}};
  output.say(fmt::format("{} frames, {} samples lost", stream.frames(), stream.lost()));
  return 0;
}

const Registration kLive{{
    "live",
    "taxels under pressure on the terminal, each at its place on the surface",
    "triskin live forearm.json --link sim --seconds 2",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("DESIGN", options->design, "design file; may be left out with --protocol icub");
      app.add_option("--protocol", options->protocol,
                     "triskin: full stream; icub: what MTB4 skin boards send, 8 bits a taxel")
          ->check(CLI::IsMember({"triskin", "icub"}));
      add_link_options(app, options->link);
      app.add_option("--seconds", options->seconds, "of the link's time; default: until Ctrl-C")
          ->check(CLI::Range(0.0, 1e7));
      app.add_option("--press", options->press,
                     "simulated link: the virtual finger presses this module (-1: none; without a scene it walks)")
          ->check(CLI::Range(kNobody, 1'000'000));
      app.add_option("--taxel", options->taxel, "with --press: one taxel of the module, with the finger tip")
          ->check(CLI::Range(0, 11));
      return [options](Output& output) { return run(*options, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli
