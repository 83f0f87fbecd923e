// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

namespace triskin::geometry::surface_lattice {

/// Symmetric positive definite system whose rows start late: vertices sorted along a line meet only near ones. Factored
/// in place by Cholesky within the envelope. Storage is kept between uses.
class EnvelopeSystem {
 public:
  /// Empty system of `blocks` 2 × 2 blocks; row block r holds entries from block first[r] on.
  void reset(const std::vector<int>& first);
  /// Adds to the entry (row, column), row ≥ column, inside the envelope.
  void add(int row, int column, double value) {
    values_[start_[static_cast<std::size_t>(row)] + static_cast<std::size_t>(column)] += value;
  }
  [[nodiscard]] double& right(int row) { return right_[static_cast<std::size_t>(row)]; }
  /// Solves; afterwards right() holds the solution. Cost: rows × width².
  void solve();

 private:
  // Start of each row in values_ minus its first column. The difference wraps round, and back on use.
  std::vector<std::size_t> start_;
  std::vector<int> first_;
  std::vector<double> values_, right_;
};

}  // namespace triskin::geometry::surface_lattice
