// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace triskin::placement {

/// The constraint weight·x ≤ limit.
template <std::size_t D>
struct LinearRow {
  std::array<double, D> weight{};
  double limit = 0.0;
};

/// Work space of a linear program of few variables. It keeps its memory, so each thread needs its own object.
template <std::size_t D>
struct LinearWork {
  std::vector<LinearRow<D>> rows;
  LinearWork<D - 1> fewer;
};
template <>
struct LinearWork<1> {
  std::vector<LinearRow<1>> rows;
};

/// Parametrizes the points on the plane of a row: x[pivot] = at + Σ slope·(the others).
template <std::size_t D>
class LinearPlane {
 public:
  explicit LinearPlane(const LinearRow<D>& row) {
    for (std::size_t k = 1; k < D; ++k) {
      if (std::abs(row.weight[k]) > std::abs(row.weight[pivot_])) pivot_ = k;
    }
    steepest_ = std::abs(row.weight[pivot_]);
    at_ = row.limit / row.weight[pivot_];
    slope_ = others(row.weight);
    for (double& s : slope_) s /= -row.weight[pivot_];
  }
  [[nodiscard]] double steepest() const { return steepest_; }
  [[nodiscard]] std::size_t pivot() const { return pivot_; }
  [[nodiscard]] std::array<double, D - 1> others(const std::array<double, D>& v) const {
    std::array<double, D - 1> rest{};
    for (std::size_t k = 0, m = 0; k < D; ++k) {
      if (k != pivot_) rest[m++] = v[k];
    }
    return rest;
  }
  /// Restricts a row, or an objective with any limit, to the plane.
  [[nodiscard]] LinearRow<D - 1> on_plane(const LinearRow<D>& row) const {
    LinearRow<D - 1> next{others(row.weight), row.limit - row.weight[pivot_] * at_};
    for (std::size_t m = 0; m + 1 < D; ++m) next.weight[m] += row.weight[pivot_] * slope_[m];
    return next;
  }
  [[nodiscard]] std::array<double, D> point(const std::array<double, D - 1>& rest) const {
    std::array<double, D> x{};
    x[pivot_] = at_;
    for (std::size_t k = 0, m = 0; k < D; ++k) {
      if (k == pivot_) continue;
      x[k] = rest[m];
      x[pivot_] += slope_[m] * rest[m];
      ++m;
    }
    return x;
  }

 private:
  std::size_t pivot_ = 0;
  double steepest_ = 0.0, at_ = 0.0;
  std::array<double, D - 1> slope_{};
};

inline constexpr double kLinearTolerance = 1e-10, kFlat = 1e-13;

inline bool maximize(const std::array<double, 1>& objective, const std::array<double, 1>& low,
                     const std::array<double, 1>& high, LinearWork<1>& work, std::array<double, 1>& x) {
  double least = low[0], most = high[0];
  for (const auto& [weight, limit] : work.rows) {
    if (weight[0] > kFlat)
      most = std::min(most, limit / weight[0]);
    else if (weight[0] < -kFlat)
      least = std::max(least, limit / weight[0]);
    else if (limit < -kLinearTolerance)
      return false;
  }
  x[0] = objective[0] > 0.0 ? most : least;
  return least <= most + kLinearTolerance;
}

/// Maximizes objective·x over low ≤ x ≤ high and work.rows; returns false if nothing satisfies all rows (within
/// 1e-10). Rows are added one by one: if the optimum so far breaks a row, the new one lies on it, which leaves a
/// program of one variable less (Seidel, 1991). Rows that bind should come first: expected cost O(rows), O(rows^D) at
/// worst.
template <std::size_t D>
bool maximize(const std::array<double, D>& objective, const std::array<double, D>& low,
              const std::array<double, D>& high, LinearWork<D>& work, std::array<double, D>& x) {
  for (std::size_t k = 0; k < D; ++k) x[k] = objective[k] > 0.0 ? high[k] : low[k];
  for (std::size_t n = 0; n < work.rows.size(); ++n) {
    const LinearRow<D> row = work.rows[n];
    double value = -row.limit;
    for (std::size_t k = 0; k < D; ++k) value += row.weight[k] * x[k];
    if (value <= kLinearTolerance) continue;
    const LinearPlane<D> plane(row);
    if (plane.steepest() < kFlat) return false;
    auto& rows = work.fewer.rows;
    rows.clear();
    LinearRow<D> face;
    for (const double sign : {1.0, -1.0}) {
      face.weight[plane.pivot()] = sign;
      face.limit = sign > 0.0 ? high[plane.pivot()] : -low[plane.pivot()];
      rows.push_back(plane.on_plane(face));
    }
    for (std::size_t k = 0; k < n; ++k) rows.push_back(plane.on_plane(work.rows[k]));
    std::array<double, D - 1> rest{};
    if (!maximize(plane.on_plane({objective, 0.0}).weight, plane.others(low), plane.others(high), work.fewer, rest))
      return false;
    x = plane.point(rest);
  }
  return true;
}

}  // namespace triskin::placement
