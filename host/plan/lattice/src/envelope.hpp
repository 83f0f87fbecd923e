// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

namespace triskin::lattice {

/// Solves a symmetric positive definite system whose rows start late, because vertices sorted along a line meet only
/// near ones. Cholesky factorization works in place within the envelope. Storage is kept between uses.
class EnvelopeSystem {
 public:
  /// Empties the system to `blocks` 2 × 2 blocks; row block r holds entries from block first[r] on.
  void reset(const std::vector<int>& first);
  /// Adds to the entry (row, column), row ≥ column, inside the envelope.
  void add(int row, int column, double value) {
    values_[start_[static_cast<std::size_t>(row)] + static_cast<std::size_t>(column)] += value;
  }
  [[nodiscard]] double& right(int row) { return right_[static_cast<std::size_t>(row)]; }
  /// Solves the system; afterwards right() holds the solution. Cost: rows × width².
  void solve();

 private:
  // Holds the start of each row in values_ minus its first column. The difference wraps around, and back on use.
  std::vector<std::size_t> start_;
  std::vector<int> first_;
  std::vector<double> values_, right_;
};

}  // namespace triskin::lattice
