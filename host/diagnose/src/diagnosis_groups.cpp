// SPDX-License-Identifier: GPL-3.0-or-later
// Finds one cause for many modules: breaks that make modules of a switched patch unreachable, and taxels with shifted
// rest values.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "cover_place.hpp"
#include "missing_modules.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/design/off_rest.hpp"
#include "verification.hpp"

namespace triskin::device {
namespace {

using Counts = std::array<double, layout::kTaxelsPerModule>;

// Returns how much the temperature pads have changed since rest; the same warming affects the other taxels.
double warming_counts(const wire::ModuleTaxels& now, const Counts& rest) {
  double sum = 0.0;
  int pads = 0;
  for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) {
    if (layout::measures_pressure(t) || !now.is_valid(t)) continue;
    sum += now.value[t] - rest[t];
    ++pads;
  }
  return pads == 0 ? 0.0 : sum / pads;
}

int taxels_off_rest(const wire::ModuleTaxels& now, const Counts& rest) {
  const double warming = warming_counts(now, rest);
  int off = 0;
  for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) {
    if (!layout::measures_pressure(t) || !now.is_valid(t)) continue;
    off += std::abs(now.value[t] - rest[t] - warming) >= kMaxRestError_counts ? 1 : 0;
  }
  return off;
}

}  // namespace

// Modules that a backup table leaves out already have their finding.
void Diagnosis::examine_missing(const PatchState& p, const std::set<int>& missing) {
  std::set<int> alive;
  for (const int m : missing) {
    if (adopter_.contains(m)) alive.insert(m);
  }
  for (MissingCause& c : explain_missing(design_, p.patch, missing, alive)) {
    std::vector<int> concerned = c.behind;
    if (c.kind == FindingKind::kMissingModule) concerned.push_back(c.module);
    if (std::ranges::none_of(concerned, [&](int m) { return p.reads(m); })) continue;
    std::erase(c.behind, c.module);
    const bool joint = c.kind == FindingKind::kMissingJoint;
    std::string text = joint ? fmt::format("nothing passes {}", joint_text(design_, c.module, c.other))
                             : fmt::format("module {} was not found: it or all of its joints are broken", c.module);
    if (joint && !concerned.empty())
      text += fmt::format("; behind it {} {} out of reach: {}", counted(concerned.size(), "module"),
                          agreeing(concerned.size(), "is", "are"), fmt::join(concerned, ", "));
    if (!joint && !c.behind.empty()) text += fmt::format("; behind it are out of reach: {}", fmt::join(c.behind, ", "));
    if (!alive.empty())
      text += fmt::format("; the controller of patch {} reads {} meanwhile", adopter_.at(*alive.begin()),
                          fmt::join(alive, ", "));
    Finding& f = add(c.kind, c.module, p.patch, fmt::format("patch {}: {}", p.patch, text),
                     joint ? fmt::format("solder this joint anew; if that does not help, module {} is dead", c.module)
                           : "check its supply and its joints, then the module");
    f.other = c.other;
    f.behind = c.behind;
  }
  bad_.insert(missing.begin(), missing.end());
  explained_.insert(missing.begin(), missing.end());
}

// A module with its own fault is repaired first and has other rest values afterwards.
void Diagnosis::examine_rest() {
  if (rest_.empty()) return;
  design::OffRest all;
  for (const PatchState& p : patches_) {
    for (std::size_t row = 0; p.usable && row < std::min(p.now.count, p.image.module_count); ++row) {
      const int module = p.module(row);
      if (bad_.contains(module)) continue;
      const int off = taxels_off_rest(p.now.modules[row], rest_.at(static_cast<std::size_t>(module)));
      if (off > 0) all.modules.push_back(module);
      all.taxels += off;
    }
  }
  if (all.modules.empty()) return;
  std::ranges::sort(all.modules);
  // The modules themselves work, so modules_ok includes them.
  Finding& f = add(FindingKind::kStaleRest, -1, -1, sentence(all),
                   "take everything off the skin and tare; what was exchanged or taken away since the last tare rests "
                   "elsewhere");
  f.module = all.modules.front();
  f.place = place_on_cover(design_, f.module);
  f.behind.assign(all.modules.begin() + 1, all.modules.end());
}

}  // namespace triskin::device
