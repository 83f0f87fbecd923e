// SPDX-License-Identifier: GPL-3.0-or-later
#include "offset_lines.hpp"

#include <algorithm>
#include <iterator>

#include "triskin/diagnose/offset_report.hpp"

namespace triskin::cli {

namespace {

bool is_starting(const wire::Offsets& offsets) {
  return std::ranges::all_of(offsets.rows(),
                             [](const wire::ModuleOffsets& m) { return m.state == wire::OffsetState::kSearching; });
}

}  // namespace

nlohmann::json read_offset_lines(session::Bus& bus, const design::Design& design, std::vector<std::string>& lines) {
  nlohmann::json list = nlohmann::json::array();
  for (const session::PatchOffsets& p : session::read_offsets(bus, design)) {
    // A controller that has just started has no offsets to report yet.
    if (!is_starting(p.offsets)) std::ranges::move(diagnose::describe(design, p), std::back_inserter(lines));
    for (std::size_t row = 0; row < p.modules.size(); ++row) {
      const wire::ModuleOffsets& m = p.offsets.modules[row];
      list.push_back({{"module", design::number_of(design, p.modules[row])},
                      {"state", diagnose::kOffsetStateNames.name(m.state)},
                      {"results_change", diagnose::kLatchingNames.name(m.latching)},
                      {"outside", m.outside},
                      {"offset_steps", m.steps}});
    }
  }
  return list;
}

}  // namespace triskin::cli
