// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/diagnose/offset_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "triskin/base/counted.hpp"

namespace triskin::diagnose {

using session::PatchOffsets;
using wire::OffsetState;

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

std::vector<std::string> describe(const design::Design& design, const PatchOffsets& patch) {
  std::vector<std::string> lines{sum_text(patch)};
  for (std::size_t row = 0; row < patch.modules.size(); ++row) {
    const wire::ModuleOffsets& m = patch.offsets.modules[row];
    if (m.state != OffsetState::kOutside) continue;
    std::vector<std::string> at_end, off_middle;
    for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) {
      if ((m.outside >> t & 1) == 0) continue;
      const int rest = patch.rest.modules[row][t];
      const std::string offset = fmt::format("offset {:.2f} pF", m.steps[t] * wire::kOffsetStep_pF);
      if (rest == 0 || rest == 0xFFFF)
        at_end.push_back(fmt::format("{} ({})", t, offset));
      else
        off_middle.push_back(fmt::format("{} ({} counts of range left for pressure, {})", t, rest, offset));
    }
    if (!at_end.empty())
      lines.push_back(fmt::format("module {}: no offset brings taxel {} into its range: electrode shorted or open",
                                  design::number_of(design, patch.modules[row]), fmt::join(at_end, ", ")));
    if (!off_middle.empty())
      lines.push_back(
          fmt::format("module {}: rests off the middle of the range: taxel {}; not pressed: its electrode is "
                      "beyond the offsets, or was touched while they were searched",
                      design::number_of(design, patch.modules[row]), fmt::join(off_middle, ", ")));
  }
  return lines;
}

}  // namespace triskin::diagnose
