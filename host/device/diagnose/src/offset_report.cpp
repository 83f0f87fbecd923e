// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/diagnose/offset_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "triskin/base/counted.hpp"
#include "triskin/session/address_users.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_table.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::diagnose {
namespace {

using wire::OffsetState;

std::string taxels_in(std::uint16_t mask, const wire::ModuleOffsets& m) {
  std::string text;
  for (unsigned t = 0; t < layout::kTaxelsPerModule; ++t) {
    if ((mask >> t & 1) == 0) continue;
    text += fmt::format("{}{} (offset {:.2f} pF)", text.empty() ? "" : ", ", t, m.steps[t] * wire::kOffsetStep_pF);
  }
  return text;
}

}  // namespace

std::vector<PatchOffsets> read_offsets(session::Bus& bus, const design::Design& design) {
  std::vector<PatchOffsets> all;
  for (const std::uint8_t node : session::lone_addresses(bus.discover())) {
    const layout::PatchIndex patch = design::patch_at(design, layout::NodeAddress{node});
    if (patch < 0) continue;
    session::Controller c(bus, node);
    if (c.active_table().design_id != design.design_id) continue;
    try {
      PatchOffsets p{patch, {}, c.offsets()};
      const layout::PatchImage image = session::image_of(design, patch);
      for (const layout::ModuleRow& row : image.rows()) p.modules.push_back(session::module_of(design, row));
      if (p.modules.size() == p.offsets.count) all.push_back(std::move(p));
    } catch (const session::Refused& e) {
      if (e.code() != wire::nrc::kOutOfRange) throw;
    }
  }
  return all;
}

namespace {

std::string sum_text(const PatchOffsets& patch) {
  const auto count = [&](OffsetState s) {
    return std::ranges::count(patch.offsets.rows(), s, &wire::ModuleOffsets::state);
  };
  const auto searching = count(OffsetState::kSearching);
  const auto stored = count(OffsetState::kKept), found = count(OffsetState::kFound) + count(OffsetState::kOutside);
  const auto unavailable = static_cast<std::ptrdiff_t>(patch.offsets.count) - stored - found - searching;
  return fmt::format("patch {}: offsets of {}: {} stored, {} newly found{}{}; electrodes at the {} input", patch.patch,
                     counted(patch.offsets.count, "module"), stored, found,
                     searching > 0 ? fmt::format(", {} being searched", searching) : "",
                     unavailable > 0 ? fmt::format(", {} unavailable", unavailable) : "",
                     patch.offsets.positive_input ? "positive" : "negative");
}

}  // namespace

std::vector<std::string> describe(const PatchOffsets& patch) {
  std::vector<std::string> lines{sum_text(patch)};
  for (std::size_t row = 0; row < patch.modules.size(); ++row) {
    const wire::ModuleOffsets& m = patch.offsets.modules[row];
    if (m.state == OffsetState::kOutside) {
      lines.push_back(
          fmt::format("module {}: no offset brings taxel {} to the middle of its range: electrode shorted, open, or "
                      "touched while the offsets were searched",
                      patch.modules[row], taxels_in(m.outside, m)));
    }
  }
  return lines;
}

}  // namespace triskin::diagnose
