// SPDX-License-Identifier: GPL-3.0-or-later
#include "envelope.hpp"

#include <algorithm>
#include <cmath>

namespace triskin::lattice {
namespace {

// Keeps four sums side by side, because a single one would wait for each addition.
double dot(const double* a, const double* b, int count) {
  double s0 = 0.0, s1 = 0.0, s2 = 0.0, s3 = 0.0;
  int k = 0;
  for (; k + 4 <= count; k += 4) {
    s0 += a[k] * b[k];
    s1 += a[k + 1] * b[k + 1];
    s2 += a[k + 2] * b[k + 2];
    s3 += a[k + 3] * b[k + 3];
  }
  for (; k < count; ++k) s0 += a[k] * b[k];
  return (s0 + s1) + (s2 + s3);
}

}  // namespace

void EnvelopeSystem::reset(const std::vector<int>& first) {
  start_.clear();
  first_.clear();
  std::size_t length = 0;
  for (std::size_t block = 0; block < first.size(); ++block) {
    for (std::size_t half = 0; half < 2; ++half) {
      const std::size_t row = 2 * block + half, column = 2 * static_cast<std::size_t>(first[block]);
      start_.push_back(length - column);
      first_.push_back(static_cast<int>(column));
      length += row + 1 - column;
    }
  }
  values_.assign(length, 0.0);
  right_.assign(2 * first.size(), 0.0);
}

// The diagonal holds the reciprocals of the factor's, which saves one division per entry and costs one per row.
void EnvelopeSystem::solve() {
  const int rows = static_cast<int>(right_.size());
  const auto entry = [&](int row, int column) {
    return values_.data() + (start_[static_cast<std::size_t>(row)] + static_cast<std::size_t>(column));
  };
  for (int row = 0; row < rows; ++row) {
    const int begin = first_[static_cast<std::size_t>(row)];
    double right_side = right(row), diagonal = *entry(row, row);
    for (int column = begin; column < row; ++column) {
      const int from = std::max(begin, first_[static_cast<std::size_t>(column)]);
      double& value = *entry(row, column);
      value = (value - dot(entry(row, from), entry(column, from), column - from)) * *entry(column, column);
      diagonal -= value * value;
      right_side -= value * right(column);
    }
    const double reciprocal = 1.0 / std::sqrt(std::max(diagonal, 1e-12));
    *entry(row, row) = reciprocal;
    right(row) = right_side * reciprocal;
  }
  for (int row = rows - 1; row >= 0; --row) {
    const double x = right(row) * *entry(row, row);
    right(row) = x;
    for (int column = first_[static_cast<std::size_t>(row)]; column < row; ++column)
      right(column) -= *entry(row, column) * x;
  }
}

}  // namespace triskin::lattice
