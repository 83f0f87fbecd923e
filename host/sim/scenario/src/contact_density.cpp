// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/scenario/contact_density.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "triskin/base/error.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/design/tile.hpp"
#include "triskin/recording/recorded_skin.hpp"
#include "triskin/recording/recording.hpp"
#include "triskin/skin/touch_map.hpp"

namespace triskin::scenario {
namespace {

constexpr double kStep_s = 0.01;
constexpr double kMaxDuration_s = 1e5;

std::uint64_t end_of_contacts(const hardware::Scene& scene, double duration_s) {
  if (scene.contacts.empty()) throw InputError("the scene has no contacts, so nothing says where modules matter");
  if (duration_s > 0.0) return static_cast<std::uint64_t>(duration_s * 1e6);
  std::uint64_t end_us = 0;
  for (const hardware::Contact& c : scene.contacts) end_us = std::max(end_us, hardware::end_of(c));
  if (end_us == hardware::kForever)
    throw InputError("a contact of the scene never ends; say with --seconds for how long it is looked at");
  return end_us;
}

bool presses(const hardware::ContactState& contact, const design::Vec3& at_mm) {
  return contact.force_n > 0.0 && (at_mm - contact.position_mm).norm() < contact.radius_mm;
}

// Returns the places of the pressure taxels of a module.
std::vector<design::Vec3> pads_of(const design::Design& design, int rotation, std::size_t module) {
  std::vector<design::Vec3> pads;
  const auto taxels = design::taxels_of(design.layout.modules[module], rotation);
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    if (layout::measures_pressure(t)) pads.push_back(taxels[t].position_mm);
  }
  return pads;
}

double touched_s(const std::vector<hardware::Contact>& contacts, const std::vector<design::Vec3>& pads,
                 std::uint64_t end_us) {
  std::vector<const hardware::Contact*> near;
  for (const hardware::Contact& c : contacts) {
    if (std::ranges::any_of(pads, [&](const design::Vec3& p) { return hardware::reaches(c, p); })) near.push_back(&c);
  }
  if (near.empty()) return 0.0;
  double total_s = 0.0;
  const auto step_us = static_cast<std::uint64_t>(kStep_s * 1e6);
  for (std::uint64_t at_us = step_us / 2; at_us < end_us; at_us += step_us) {
    const bool touched = std::ranges::any_of(near, [&](const hardware::Contact* c) {
      const auto now = hardware::state_of(*c, at_us);
      return now && std::ranges::any_of(pads, [&](const design::Vec3& p) { return presses(*now, p); });
    });
    if (touched) total_s += kStep_s;
  }
  return total_s;
}

}  // namespace

std::size_t ContactDensity::touched_modules() const {
  return static_cast<std::size_t>(std::ranges::count_if(touched_s, [](double s) { return s > 0.0; }));
}

ContactDensity density_of_scene(const hardware::Scene& scene, double duration_s) {
  const std::uint64_t end_us = end_of_contacts(scene, duration_s);
  if (static_cast<double>(end_us) > kMaxDuration_s * 1e6)
    throw InputError(fmt::format("the contacts last longer than {:g} s; say less with --seconds", kMaxDuration_s));
  ContactDensity density{scene.design, {}, static_cast<double>(end_us) * 1e-6};
  const auto wiring = design::wiring_of(scene.design);
  for (std::size_t m = 0; m < wiring.size(); ++m)
    density.touched_s.push_back(
        scenario::touched_s(scene.contacts, pads_of(scene.design, wiring[m].routed.rotation, m), end_us));
  return density;
}

ContactDensity density_of_recording(const std::filesystem::path& path) {
  recording::RecordedSkin skin = recording::recorded_skin(path.string());
  ContactDensity density{std::move(skin.design), {}, 0.0};
  const std::size_t modules = density.design.layout.modules.size();
  density.touched_s.assign(modules, 0.0);
  skin::TouchMap touches(density.design, skin.rest);
  std::vector<std::uint64_t> last_us(modules, 0);
  const recording::Summary summary = recording::read_recording(path, [&](const recording::ModuleSample& s) {
    const auto m = static_cast<std::size_t>(s.module);
    if (m >= modules) return;
    touches.add({s.module, s.link_time_us, s.sample});
    const auto change = touches.change(s.module);
    // A longer gap in the recording does not count as a touch.
    constexpr std::uint64_t kMaxInterval_us = 500'000;
    const std::uint64_t since_us = last_us[m] == 0 ? 0 : s.link_time_us - last_us[m];
    if (std::ranges::max(change) >= skin::TouchMap::kPressed_counts && since_us < kMaxInterval_us)
      density.touched_s[m] += static_cast<double>(since_us) * 1e-6;
    last_us[m] = s.link_time_us;
  });
  density.duration_s = static_cast<double>(summary.last_us - summary.first_us) * 1e-6;
  return density;
}

namespace {

nlohmann::json region_of(const design::Design& design, layout::ModuleId module, double weight) {
  constexpr double kRadius_mm = 2.0 * design::kHeight_mm / 3.0;  // The centre of a module is this far from its corners.
  const design::Vec3 at = hardware::center_of(design, module);
  return {{"name", fmt::format("touched {}", design::number_of(design, module))},
          {"sphere", {{"center_mm", {at.x(), at.y(), at.z()}}, {"radius_mm", kRadius_mm}}},
          {"weight", std::round(weight * 1000.0) / 1000.0}};
}

}  // namespace

std::string regions_text(const ContactDensity& density, double max_weight) {
  if (!(max_weight > 1.0 && max_weight <= 1000.0))
    throw InputError(fmt::format("the weight {:g} must be more than 1 and at most 1000", max_weight));
  const double longest_s = density.touched_s.empty() ? 0.0 : std::ranges::max(density.touched_s);
  if (longest_s <= 0.0)
    throw InputError(
        "no module was touched, so nothing says where modules matter; touch the skin, or look at the rest values");
  std::vector<std::size_t> order(density.touched_s.size());
  std::iota(order.begin(), order.end(), 0U);
  // Where regions overlap, the last one counts, so the most important ones come last.
  std::ranges::stable_sort(order, {}, [&](std::size_t m) { return density.touched_s[m]; });
  nlohmann::json regions = nlohmann::json::array();
  for (const std::size_t m : order) {
    if (density.touched_s[m] > 0.0)
      regions.push_back(
          region_of(density.design, layout::ModuleId{m}, 1.0 + (max_weight - 1.0) * density.touched_s[m] / longest_s));
  }
  return nlohmann::json{{"format", "triskin-regions"}, {"version", 1}, {"elsewhere", 1}, {"regions", regions}}.dump(1) +
         "\n";
}

}  // namespace triskin::scenario
