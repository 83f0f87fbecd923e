// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/diagnose/read_rest.hpp"

#include <algorithm>

#include "triskin/layout/rest.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_table.hpp"

namespace triskin::device {
namespace {

constexpr std::uint64_t kBetween_us = 50'000, kStart_us = 3'000'000;
constexpr std::size_t kReadings = 3;

void take(const std::array<wire::LiveTaxels, kReadings>& readings, std::size_t row,
          std::array<double, layout::kTaxelsPerModule>& rest) {
  for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) {
    std::array<std::uint16_t, kReadings> values{};
    bool valid = true;
    for (std::size_t k = 0; k < kReadings; ++k) {
      valid = valid && row < readings[k].count && readings[k].modules[row].is_valid(t);
      values[k] = readings[k].modules[row].value[t];
    }
    if (!valid) continue;
    std::ranges::sort(values);
    rest[t] = values[kReadings / 2];
  }
}

bool has_values(const wire::LiveTaxels& taxels) {
  return std::ranges::none_of(taxels.rows(), [](const wire::ModuleTaxels& m) { return m.valid == 0; });
}

// A controller that has just been switched on has read nothing yet; a dead module never gives a value.
void wait_for_values(Bus& bus, Controller& controller) {
  const std::uint64_t limit_us = bus.now_us() + kStart_us;
  while (bus.now_us() < limit_us && !has_values(controller.taxels())) bus.listen(bus.now_us() + kBetween_us);
}

}  // namespace

design::RestValues read_rest(Bus& bus, const design::Design& design, design::RestValues before) {
  design::RestValues rest = std::move(before);
  if (rest.empty()) {
    rest.resize(design.layout.modules.size());
    for (auto& module : rest) module.fill(layout::kRestCounts);
  }
  for (const int patch : design::patches_here(design)) {
    const layout::PatchImage image = image_of(design, patch);
    Controller controller(bus, image.node_address);
    if (!holds_image(controller.active_table().crc, image)) continue;
    wait_for_values(bus, controller);
    std::array<wire::LiveTaxels, kReadings> readings{};
    for (wire::LiveTaxels& r : readings) {
      r = controller.taxels();
      bus.listen(bus.now_us() + kBetween_us);
    }
    for (std::size_t row = 0; row < image.module_count; ++row)
      take(readings, row, rest.at(static_cast<std::size_t>(module_of(design, image.modules[row]))));
  }
  return rest;
}

}  // namespace triskin::device
