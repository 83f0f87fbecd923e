// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace triskin::geometry {

/// weight·x ≤ limit.
template <std::size_t D>
struct LinearRow {
  std::array<double, D> weight{};
  double limit = 0.0;
};

/// What a linear program of few variables works on: one object a thread, it keeps its memory.
template <std::size_t D>
struct LinearWork {
  std::vector<LinearRow<D>> rows;
  LinearWork<D - 1> fewer;
};
template <>
struct LinearWork<1> {
  std::vector<LinearRow<1>> rows;
};

/// Maximizes objective·x over low ≤ x ≤ high and work.rows; false: nothing satisfies all rows (within 1e-10).
/// Row after row: where the optimum so far breaks a row, the new one lies on it, a program of one variable less
/// (Seidel, 1991). Rows that bind should stand first: expected cost O(rows), O(rows^D) at worst.
template <std::size_t D>
bool maximize(const std::array<double, D>& objective, const std::array<double, D>& low, const std::array<double, D>& high,
              LinearWork<D>& work, std::array<double, D>& x) {
  constexpr double kTolerance = 1e-10, kFlat = 1e-13;
  if constexpr (D == 1) {
    double least = low[0], most = high[0];
    for (const auto& [weight, limit] : work.rows) {
      if (weight[0] > kFlat) most = std::min(most, limit / weight[0]);
      else if (weight[0] < -kFlat) least = std::max(least, limit / weight[0]);
      else if (limit < -kTolerance) return false;
    }
    x[0] = objective[0] > 0.0 ? most : least;
    return least <= most + kTolerance;
  } else {
    for (std::size_t k = 0; k < D; ++k) x[k] = objective[k] > 0.0 ? high[k] : low[k];
    for (std::size_t n = 0; n < work.rows.size(); ++n) {
      const LinearRow<D> on = work.rows[n];
      double value = -on.limit;
      std::size_t pivot = 0;
      for (std::size_t k = 0; k < D; ++k) {
        value += on.weight[k] * x[k];
        if (std::abs(on.weight[k]) > std::abs(on.weight[pivot])) pivot = k;
      }
      if (value <= kTolerance) continue;
      if (std::abs(on.weight[pivot]) < kFlat) return false;
      // x[pivot] = at + Σ slope·(the others)
      const double at = on.limit / on.weight[pivot];
      std::array<double, D - 1> slope{}, goal{}, least{}, most{}, rest{};
      for (std::size_t k = 0, m = 0; k < D; ++k) {
        if (k == pivot) continue;
        slope[m] = -on.weight[k] / on.weight[pivot];
        goal[m] = objective[k] + objective[pivot] * slope[m];
        least[m] = low[k];
        most[m++] = high[k];
      }
      auto& rows = work.fewer.rows;
      rows.clear();
      const auto add = [&](const LinearRow<D>& row) {
        LinearRow<D - 1> next;
        next.limit = row.limit - row.weight[pivot] * at;
        for (std::size_t k = 0, m = 0; k < D; ++k) {
          if (k == pivot) continue;
          next.weight[m] = row.weight[k] + row.weight[pivot] * slope[m];
          ++m;
        }
        rows.push_back(next);
      };
      LinearRow<D> face;
      face.weight[pivot] = 1.0;
      face.limit = high[pivot];
      add(face);
      face.weight[pivot] = -1.0;
      face.limit = -low[pivot];
      add(face);
      for (std::size_t k = 0; k < n; ++k) add(work.rows[k]);
      if (!maximize<D - 1>(goal, least, most, work.fewer, rest)) return false;
      x[pivot] = at;
      for (std::size_t k = 0, m = 0; k < D; ++k) {
        if (k == pivot) continue;
        x[k] = rest[m];
        x[pivot] += slope[m] * rest[m];
        ++m;
      }
    }
    return true;
  }
}

}  // namespace triskin::geometry
