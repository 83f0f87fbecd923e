// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <compare>
#include <optional>
#include <vector>

#include "verification.hpp"

namespace triskin::device {

/// A place at a controller, or of a patch in the design.
struct Site {
  int patch = 0, line = 0, address = 0;
  auto operator<=>(const Site&) const = default;
};

/// A guess at how the cables are plugged: which controller and which of its lines leads to each line of each patch of
/// the design. As designed at first.
class CableMap {
 public:
  explicit CableMap(std::size_t patches);
  /// The cables of two patches are exchanged.
  void exchange_patches(int p, int q);
  /// Lines `a` and `b` of patch `p` are exchanged.
  void exchange_lines(int p, int a, int b);
  /// Place where the module of a place in the design is actually read.
  [[nodiscard]] Site seen_at(const Site& meant) const;
  /// The inverse: whose place is read there.
  [[nodiscard]] Site meant_by(const Site& seen) const;

 private:
  std::vector<int> controller_;
  std::vector<std::array<int, layout::kLines>> line_;
};

/// What was observed, read as if the cables were plugged like `map`: the states of each patch, and the touches. What a
/// controller does not sample, because its table has no row there, counts as in order when somebody answers.
struct Observation {
  std::vector<PatchState> patches;
  std::vector<TouchOutcome> touches;
};
[[nodiscard]] Observation read_through(const CableMap& map, const design::Design& design,
                                       const std::vector<PatchState>& patches,
                                       const std::vector<TouchOutcome>& touches);

/// One exchange of cables or lines that explains what was seen.
struct CableExplanation {
  int patch = -1;
  int other = -1;  ///< It is a patch; −1 means that the lines below are meant.
  int line_a = -1, line_b = -1;
  int modules = 0;  ///< So many modules are in their place once it is undone.
};
/// Exchanges that explain at least three modules each, best first; `map` becomes what they lead to. Greedy: every step
/// takes the exchange after which fewest modules are wrong. Patches that cannot be read are left alone.
[[nodiscard]] std::vector<CableExplanation> explain_cables(CableMap& map, const design::Design& design,
                                                           const std::vector<PatchState>& patches,
                                                           const std::vector<TouchOutcome>& touches);

}  // namespace triskin::device
