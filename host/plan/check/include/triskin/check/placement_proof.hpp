// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace triskin::check {

/// Tells whether a placement proof was accepted, and what it claims.
struct ProofReport {
  bool accepted = false;
  std::string reason;   ///< The reason of a rejection; empty when the proof was accepted.
  int modules = 0;      ///< The log claims this number, and if it was accepted its placement shows it.
  int upper_bound = 0;  ///< The log claims this bound, and if it was accepted its cells show it.
  // The claims refer to these values, as the log states them.
  /// The modules of the placement may overhang by this much and by `rounding_mm`; those of the bound may not at all.
  double tolerance_mm = 0.0;
  double rounding_mm = 0.0;       ///< The motion of the placement is written down this exactly.
  std::string shape;              ///< The shape is triangle, square or hexagon.
  double gap_mm = 0.0;            ///< Facing sides of modules keep this free space.
  double corner_cut_mm = 0.0;     ///< This length is cut off along each side from every corner.
  std::string weights = "none";   ///< A proof is always about the number of modules.
  double outline_area_mm2 = 0.0;  ///< The area is that of the polygon in the file, less its holes.
  /// The hash covers the edges (FNV-1a, 64 bits), so equal outlines have equal values, wherever their rings begin.
  std::string outline_hash;
  std::int64_t cells = 0;
  std::int64_t regions = 0;  ///< The checker computed a bound for each of these boxes of motions.
  std::int64_t pairs = 0;    ///< The checker compared the needs of this many pairs of modules.
  double seconds = 0.0;
};

/// States what the reader of a proof expects it to be about; unset values are not compared.
struct ProofExpectation {
  std::optional<double> tolerance_mm = std::nullopt;   ///< The comparison allows 1e-12 of the value.
  std::optional<double> gap_mm = std::nullopt;         ///< The comparison allows 1e-9 mm.
  std::optional<double> corner_cut_mm = std::nullopt;  ///< The comparison allows 1e-12 of the value.
  std::optional<std::string> shape = std::nullopt;
  std::optional<std::string> outline_hash = std::nullopt;
  std::optional<int> modules = std::nullopt;  ///< The bound and the placement must both have this number.
};

/// Checks the log that `triskin place --proof` wrote against the polygon (docs/placement.md has the format): its
/// polygon is the file's, its cells cover every motion of one period of the grid, in no cell more than `upper_bound`
/// modules can lie inside, and the placement has `modules` of them within the tolerance. Interval arithmetic with
/// outward rounding; shares no code with the solver. Errors: InputError when a file cannot be read as polygon or log; a
/// wrong proof is no error but a rejection with its reason. One thread; thread-safe. Cost: about as many boxes as the
/// log has cells, each with the modules near the outline. A log that does not fit `expected` is rejected.
[[nodiscard]] ProofReport check_placement_proof(const std::filesystem::path& log, const std::filesystem::path& polygon,
                                                const ProofExpectation& expected = {});

/// Checks the same from the texts of both files; messages call them "proof" and "polygon".
[[nodiscard]] ProofReport check_placement_proof_text(const std::string& log, const std::string& polygon,
                                                     const ProofExpectation& expected = {});

}  // namespace triskin::check
