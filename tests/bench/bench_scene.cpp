// SPDX-License-Identifier: GPL-3.0-or-later
// Measures what each effect of a scene, and the level of its controllers, costs: the virtual time that passes in a
// second of processor time.
#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <functional>
#include <numeric>
#include <string>

#include "bench.hpp"
#include "triskin/mesh/generate.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/pipeline/make_design.hpp"
#include "triskin/scenario/running_skin.hpp"

namespace triskin::cli {
namespace {

using hardware::Scene;

constexpr std::uint64_t kSecond_us = 1'000'000;

struct Case {
  const char* name;
  std::function<void(Scene&)> add;
};

std::vector<Case> cases() {
  const auto day = [](double from, double to) {
    return std::vector<hardware::TimedValue>{{0, from}, {100 * kSecond_us, to}};
  };
  std::vector<Case> list{
      {"noise", [](Scene& s) { s.effects.noise_counts = 3.0; }},
      {"drift", [](Scene& s) { s.effects.drift_counts_per_s = 1.0; }},
      {"layer", [](Scene& s) { s.effects.pads.layer = hardware::LayerEffect{}; }},
      {"temperature", [=](Scene& s) { s.effects.pads.temperature = hardware::TemperatureEffect{day(20.0, 30.0)}; }},
      {"humidity", [=](Scene& s) { s.effects.pads.humidity = hardware::HumidityEffect{day(40.0, 60.0)}; }},
      {"crosstalk", [](Scene& s) { s.effects.pads.crosstalk = hardware::CrosstalkEffect{}; }},
      {"edges", [=](Scene& s) { s.effects.pads.edges = hardware::EdgeEffect{}; }},
      {"supply", [=](Scene& s) { s.effects.pads.supply = hardware::SupplyEffect{day(3.3, 3.0)}; }},
      {"emi", [](Scene& s) { s.effects.pads.emi = {{0, kSecond_us / 5, kSecond_us, 50.0}}; }},
  };
  list.push_back({"all", [all = list](Scene& s) {
                    for (const Case& c : all) c.add(s);
                  }});
  list.push_back(
      {"level table", [](Scene& s) { s.levels.assign(s.design.patches.size(), hardware::ControllerLevel::kTable); }});
  return list;
}

design::Design forearm() {
  const Scratch scratch;
  const std::filesystem::path file = scratch.path() / "forearm.obj";
  mesh::write_mesh(file, mesh::generate(*mesh::shape_named("forearm"), {}));
  pipeline::DesignOptions options;
  options.iterations = 20;
  options.time_limit_s = 300.0;
  return pipeline::make_design(file, options).design;
}

// A finger of 6 mm slides along the cover all the time.
hardware::Contact sliding_finger(const design::Design& design) {
  const auto middle = [&](std::size_t module) {
    const auto& corners = design.layout.modules.at(module).corner_mm;
    return design::Vec3((corners[0] + corners[1] + corners[2]) / 3.0);
  };
  hardware::Contact finger;
  finger.until_us = kSecond_us;
  finger.every_us = kSecond_us;
  finger.position_mm = middle(0);
  finger.to_mm = middle(design.layout.modules.size() - 1);
  return finger;
}

double processor_s_of(const Scene& scene, double virtual_s) {
  scenario::RunningSkin skin(scene, {}, {});
  const double start_s = processor_s();
  skin.run_until(skin.now_us() + static_cast<std::uint64_t>(virtual_s * 1e6));
  return processor_s() - start_s;
}

nlohmann::json rows(const BenchOptions& options, Output& output) {
  Scene bare;
  bare.design = forearm();
  bare.contacts = {sliding_finger(bare.design)};
  const double virtual_s = options.quick ? 5.0 : 60.0;
  const std::size_t modules = bare.design.layout.modules.size();
  nlohmann::json result = nlohmann::json::array();
  const auto note = [&](const std::string& name, double with_s, double without_s) {
    result.push_back({{"effect", name},
                      {"modules", modules},
                      {"virtual_s", virtual_s},
                      {"seconds", with_s},
                      {"real_time_factor", virtual_s / with_s},
                      {"ratio_to_none", with_s / without_s}});
    output.say(fmt::format("{:12} {:6.1f} times real time, {:.3f} times the cost without effects", name,
                           virtual_s / with_s, with_s / without_s));
  };
  // The bare scene runs before and after each other one, so that a change of the computer's speed cancels.
  double before_s = processor_s_of(bare, virtual_s);
  note("none", before_s, before_s);
  for (const Case& c : cases()) {
    Scene scene = bare;
    c.add(scene);
    const double with_s = processor_s_of(scene, virtual_s);
    const double after_s = processor_s_of(bare, virtual_s);
    note(c.name, with_s, std::midpoint(before_s, after_s));
    before_s = after_s;
  }
  return result;
}

const BenchSubject kScene("scene", "what each effect of a scene costs: virtual time per processor time", rows);

}  // namespace
}  // namespace triskin::cli
