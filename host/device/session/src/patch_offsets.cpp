// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/patch_offsets.hpp"

#include <algorithm>
#include <limits>

#include "triskin/design/joint.hpp"
#include "triskin/session/address_users.hpp"
#include "triskin/session/adopted_modules.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_table.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::session {

void wait_for_set_up(Bus& bus, std::span<const wire::NodeClaim> claims) {
  constexpr std::uint64_t kMax_us = 1'000'000, kPause_us = 20'000;
  const std::uint64_t until_us = bus.now_us() + kMax_us;
  for (const std::uint8_t node : lone_addresses({claims.begin(), claims.end()})) {
    Controller c(bus, node);
    const auto is_setting_up = [&] {
      const wire::ModuleStates states = c.module_states();
      return std::ranges::count(states.rows(), wire::ModuleState::kUnknown) > 0;
    };
    try {
      while (is_setting_up() && bus.now_us() < until_us) bus.listen(bus.now_us() + kPause_us);
    } catch (const NoAnswer&) {
      continue;
    } catch (const Refused&) {
      continue;
    }
  }
}

void wait_for_set_up(Bus& bus) {
  wait_for_set_up(bus, bus.discover());
}

std::vector<PatchOffsets> read_offsets(Bus& bus, const design::Design& design,
                                       std::span<const wire::NodeClaim> claims) {
  std::vector<PatchOffsets> all;
  for (const std::uint8_t node : lone_addresses({claims.begin(), claims.end()})) {
    const layout::PatchIndex patch = design::patch_at(design, layout::NodeAddress{node});
    if (patch < 0) continue;
    Controller c(bus, node);
    try {
      if (c.active_table().design_id != design.design_id) continue;
      PatchOffsets p{patch, {}, c.offsets(), c.settled_rest(), c.adoption()};
      const layout::PatchImage image = image_of(design, patch);
      for (const layout::ModuleRow& row : image.rows()) p.modules.push_back(module_of(design, row));
      if (p.modules.size() == p.offsets.count && p.offsets.count == p.rest.count) all.push_back(std::move(p));
    } catch (const NoAnswer&) {
      continue;
    } catch (const Refused& e) {
      if (e.code() != wire::nrc::kOutOfRange) throw;
    }
  }
  return all;
}

std::vector<PatchOffsets> read_offsets(Bus& bus, const design::Design& design) {
  return read_offsets(bus, design, bus.discover());
}

design::RestValues settled_rest(Bus& bus, const design::Design& design, std::span<const wire::NodeClaim> claims) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  design::RestValues rest(design.layout.modules.size());
  for (auto& module : rest) module.fill(kUnknown);
  const std::vector<PatchOffsets> patches = read_offsets(bus, design, claims);
  for (const PatchOffsets& p : patches) {
    for (std::size_t row = 0; row < p.modules.size(); ++row) {
      const wire::SettledRest::Module& settled = p.rest.modules[row];
      if (wire::SettledRest::known(settled))
        std::ranges::copy(settled, rest[static_cast<std::size_t>(p.modules[row])].begin());
    }
  }
  // The controller of another patch finds offsets of its own.
  const ModuleEnds ends = design::module_ends(design);
  for (const PatchOffsets& p : patches) {
    for (const layout::ModuleId m : adopted_modules(ends, p.modules, p.adoption)) {
      if (m >= 0) rest[static_cast<std::size_t>(m)].fill(kUnknown);
    }
  }
  return rest;
}

}  // namespace triskin::session
