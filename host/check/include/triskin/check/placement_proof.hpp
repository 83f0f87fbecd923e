// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

namespace triskin::check {

/// Verdict on a placement proof.
struct ProofReport {
  bool accepted = false;
  std::string reason;        ///< why it was rejected; empty when accepted
  int modules = 0;           ///< claimed and, when accepted, shown by the placement of the log
  int upper_bound = 0;       ///< claimed and, when accepted, shown by the cells of the log
  std::int64_t cells = 0;    ///< cells of the log
  std::int64_t regions = 0;  ///< boxes of motions whose bound was computed here
  double seconds = 0.0;
};

/// Checks the log that `triskin place --proof` wrote against the polygon (docs/placement.md has the format): its
/// polygon is the file's, its cells cover every motion of one period of the grid, in no cell more than `upper_bound`
/// modules can lie inside, and the placement holds `modules` of them within the tolerance. Interval arithmetic with
/// outward rounding; shares no code with the solver. Errors: InputError when a file cannot be read as polygon or
/// log; a wrong proof is no error but a rejection with its reason. One thread; thread-safe.
/// Cost: about as many boxes as the log has cells, each with the modules near the outline.
[[nodiscard]] ProofReport check_placement_proof(const std::filesystem::path& log, const std::filesystem::path& polygon);

/// The same from the texts of both files; messages call them "proof" and "polygon".
[[nodiscard]] ProofReport check_placement_proof_text(const std::string& log, const std::string& polygon);

}  // namespace triskin::check
