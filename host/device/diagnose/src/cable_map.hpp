// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <compare>
#include <optional>
#include <vector>

#include "verification.hpp"

namespace triskin::diagnose {

/// A place is a line and an address, either at a controller or of a patch in the design.
struct Site {
  layout::PatchIndex patch;
  int line = 0, address = 0;
  auto operator<=>(const Site&) const = default;
};

/// A map is a hypothesis about the cables: which line of which controller leads to each line of each patch of the
/// design. It starts as designed.
class CableMap {
 public:
  explicit CableMap(std::size_t patches);
  /// Exchanges the cables of two patches.
  void exchange_patches(layout::PatchIndex p, layout::PatchIndex q);
  /// Exchanges lines `a` and `b` of patch `p`.
  void exchange_lines(layout::PatchIndex p, int a, int b);
  /// Returns where the module that the design has at `meant` is actually read.
  [[nodiscard]] Site seen_at(const Site& meant) const;
  /// Inverts seen_at(): returns the place of the design that is read at `seen`.
  [[nodiscard]] Site meant_by(const Site& seen) const;

 private:
  std::vector<layout::PatchIndex> controller_;
  std::vector<std::array<int, layout::kLines>> line_;
};

/// The observation has the states of each patch and the touches as they would look if the cables were plugged like
/// `map`. A place that a controller does not sample, because its table has no row there, counts as correct when a chip
/// answers.
struct Observation {
  std::vector<PatchState> patches;
  std::vector<TouchOutcome> touches;
};
[[nodiscard]] Observation read_through(const CableMap& map, const design::Design& design,
                                       const std::vector<PatchState>& patches,
                                       const std::vector<TouchOutcome>& touches);

/// This exchange of cables or lines explains the observations.
struct CableExplanation {
  layout::PatchIndex patch = layout::PatchIndex::none();
  /// The exchange is with this patch; −1 means that the lines below are exchanged.
  layout::PatchIndex other = layout::PatchIndex::none();
  int line_a = -1, line_b = -1;
  int modules = 0;  ///< This many modules are in their place once the exchange is undone.
};
/// Returns exchanges that explain at least three modules each, best first; `map` then includes them. The search is
/// greedy: every step takes the exchange that leaves the fewest modules wrong. Patches that cannot be read are left
/// alone.
[[nodiscard]] std::vector<CableExplanation> explain_cables(CableMap& map, const design::Design& design,
                                                           const std::vector<PatchState>& patches,
                                                           const std::vector<TouchOutcome>& touches);

}  // namespace triskin::diagnose
