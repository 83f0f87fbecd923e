// SPDX-License-Identifier: GPL-3.0-or-later
#include "envelope.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace triskin::lattice {
namespace {

// Products of two rows with two columns.
struct Products {
  double r0c0, r0c1, r1c0, r1c1;
};

// Takes two products side by side, and reads each number for two of them; `count` is even.
Products products(const double* r0, const double* r1, const double* c0, const double* c1, std::size_t count) {
  std::array<double, 2> s00{}, s01{}, s10{}, s11{};
  for (std::size_t k = 0; k < count; k += 2) {
    for (std::size_t j = 0; j < 2; ++j) {
      s00[j] += r0[k + j] * c0[k + j];
      s01[j] += r0[k + j] * c1[k + j];
      s10[j] += r1[k + j] * c0[k + j];
      s11[j] += r1[k + j] * c1[k + j];
    }
  }
  return {s00[0] + s00[1], s01[0] + s01[1], s10[0] + s10[1], s11[0] + s11[1]};
}

double reciprocal_root(double pivot) {
  return 1.0 / std::sqrt(std::max(pivot, 1e-12));
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
  for (int row = 0; row < rows; row += 2) {
    const int begin = first_[static_cast<std::size_t>(row)];
    double *r0 = entry(row, begin), *r1 = entry(row + 1, begin);  // These follow the columns.
    const double *const start0 = r0, *const start1 = r1;
    double right0 = right(row), right1 = right(row + 1), d0 = 0.0, d1 = 0.0, between = 0.0;
    for (int c = begin; c < row; c += 2, r0 += 2, r1 += 2) {
      const int from = std::max(begin, first_[static_cast<std::size_t>(c)]), count = c - from;
      const double *const c0 = entry(c, from), *const c1 = entry(c + 1, from);
      const Products p =
          products(start0 + (from - begin), start1 + (from - begin), c0, c1, static_cast<std::size_t>(count));
      const double a0 = (r0[0] - p.r0c0) * c0[count], a1 = (r1[0] - p.r1c0) * c0[count];
      const double b0 = (r0[1] - p.r0c1 - a0 * c1[count]) * c1[count + 1],
                   b1 = (r1[1] - p.r1c1 - a1 * c1[count]) * c1[count + 1];
      r0[0] = a0;
      r1[0] = a1;
      r0[1] = b0;
      r1[1] = b1;
      d0 += a0 * a0 + b0 * b0;
      d1 += a1 * a1 + b1 * b1;
      between += a0 * a1 + b0 * b1;
      right0 -= a0 * right(c) + b0 * right(c + 1);
      right1 -= a1 * right(c) + b1 * right(c + 1);
    }
    r0[0] = reciprocal_root(r0[0] - d0);
    r1[0] = (r1[0] - between) * r0[0];
    r1[1] = reciprocal_root(r1[1] - d1 - r1[0] * r1[0]);
    right(row) = right0 * r0[0];
    right(row + 1) = (right1 - r1[0] * right(row)) * r1[1];
  }
  for (int row = rows - 2; row >= 0; row -= 2) {
    const double *const at0 = entry(row, row), *const at1 = entry(row + 1, row);
    const double y = right(row + 1) * at1[1], x = (right(row) - at1[0] * y) * at0[0];
    right(row) = x;
    right(row + 1) = y;
    const int begin = first_[static_cast<std::size_t>(row)];
    const double *const r0 = entry(row, begin), *const r1 = entry(row + 1, begin);
    for (int c = begin; c < row; ++c) right(c) -= r0[c - begin] * x + r1[c - begin] * y;
  }
}

}  // namespace triskin::lattice
