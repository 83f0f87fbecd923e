// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace triskin::check {

/// Verdict on a placement proof.
struct ProofReport {
  bool accepted = false;
  std::string reason;   ///< It says why the proof was rejected and is empty when it was accepted.
  int modules = 0;      ///< The log claims it, and its placement shows it when accepted.
  int upper_bound = 0;  ///< The log claims it, and its cells show it when accepted.
  // What the claims are about, as the log has it.
  double tolerance_mm =
      0.0;              ///< The modules of the placement may stand over by this; those of the bound may not at all.
  std::string shape;    ///< It is triangle, square or hexagon.
  double gap_mm = 0.0;  ///< Facing sides of modules keep this free space.
  double corner_cut_mm = 0.0;     ///< It is cut off along each side from every corner.
  std::string weights = "none";   ///< A proof is always about the number of modules.
  double outline_area_mm2 = 0.0;  ///< It is the area of the polygon in the file, less its holes.
  /// It hashes the edges (FNV-1a, 64 bits), so equal outlines have equal values, wherever their rings begin.
  std::string outline_hash;
  std::int64_t cells = 0;    ///< It counts the cells in the log.
  std::int64_t regions = 0;  ///< It counts the boxes of motions whose bound was computed here.
  double seconds = 0.0;
};

/// What the reader of a proof wants it to be about; what is not set is not compared.
struct ProofExpectation {
  std::optional<double> tolerance_mm = std::nullopt;   ///< It is compared to 1e-12 of the value.
  std::optional<double> gap_mm = std::nullopt;         ///< It is compared to 1e-9 mm.
  std::optional<double> corner_cut_mm = std::nullopt;  ///< It is compared to 1e-12 of the value.
  std::optional<std::string> shape = std::nullopt;
  std::optional<std::string> outline_hash = std::nullopt;
  std::optional<int> modules = std::nullopt;  ///< The bound and the placement must both have so many.
};

/// Checks the log that `triskin place --proof` wrote against the polygon (docs/placement.md has the format): its
/// polygon is the file's, its cells cover every motion of one period of the grid, in no cell more than `upper_bound`
/// modules can lie inside, and the placement holds `modules` of them within the tolerance. Interval arithmetic with
/// outward rounding; shares no code with the solver. Errors: InputError when a file cannot be read as polygon or
/// log; a wrong proof is no error but a rejection with its reason. One thread; thread-safe.
/// Cost: about as many boxes as the log has cells, each with the modules near the outline.
/// A log that is about something else than `expected` is rejected.
[[nodiscard]] ProofReport check_placement_proof(const std::filesystem::path& log, const std::filesystem::path& polygon,
                                                const ProofExpectation& expected = {});

/// The same from the texts of both files; messages call them "proof" and "polygon".
[[nodiscard]] ProofReport check_placement_proof_text(const std::string& log, const std::string& polygon,
                                                     const ProofExpectation& expected = {});

}  // namespace triskin::check
