// SPDX-License-Identifier: GPL-3.0-or-later
#include "search/joint_program.hpp"

#include <algorithm>
#include <cmath>

namespace triskin::placement {
namespace {

constexpr int kMaxPrograms = 90, kMaxPivots = 60;
constexpr double kWorthEntering = 1e-9;  // A row enters the basis if it lies below the optimum so far by this share.
constexpr double kMinPivot = 1e-9;
// The sum of a core must be negative by this share of what is added, which is far above the rounding of the addition.
constexpr double kRounding = 1e-13;

}  // namespace

// The dual program: multipliers >= 0 whose sum is 1, with the least sum of levels, where the gradients must cancel but
// for multipliers of the faces of the box. It has four equations, so a basis has four columns.
struct JointProgram::Basis {
  static constexpr std::size_t kFaces = 6;  // Before the rows come the faces of the box, ±u[k] <= 1.
  std::array<std::size_t, 4> column{};
  std::array<Column, 4> inverse{};  // The rows of the inverse of the matrix of the columns.
  std::array<double, 4> multiplier{}, cost{};

  [[nodiscard]] Column prices() const {
    Column y{};
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t m = 0; m < 4; ++m) y[m] += cost[k] * inverse[k][m];
    }
    return y;
  }
  // Exchanges the column that first becomes 0 when the new one grows. Returns false if none does.
  [[nodiscard]] bool enter(std::size_t index, const Column& a, double its_cost) {
    Column direction{};
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t m = 0; m < 4; ++m) direction[k] += inverse[k][m] * a[m];
    }
    std::size_t leaving = 4;
    for (std::size_t k = 0; k < 4; ++k) {
      if (direction[k] < kMinPivot) continue;
      if (leaving == 4 || multiplier[k] * direction[leaving] < multiplier[leaving] * direction[k]) leaving = k;
    }
    if (leaving == 4) return false;
    const double grown = multiplier[leaving] / direction[leaving], pivot = direction[leaving];
    for (double& v : inverse[leaving]) v /= pivot;
    for (std::size_t k = 0; k < 4; ++k) {
      if (k == leaving) continue;
      multiplier[k] = std::max(0.0, multiplier[k] - grown * direction[k]);
      for (std::size_t m = 0; m < 4; ++m) inverse[k][m] -= direction[k] * inverse[leaving][m];
    }
    multiplier[leaving] = grown;
    column[leaving] = index;
    cost[leaving] = its_cost;
    return true;
  }
};

void JointProgram::begin(std::size_t tiles) {
  rows_.clear();
  left_out_.assign(tiles, 0);
  scale_mm_ = 1e-300;
}

void JointProgram::add(std::uint32_t tile, const std::array<double, 3>& gradient, double level) {
  rows_.push_back({tile, gradient, level});
  for (const double g : gradient) scale_mm_ = std::max(scale_mm_, std::abs(g));
}

bool JointProgram::contradictory(int drops) {
  programs_ = 0;
  return contradicts(drops);
}

bool JointProgram::contradicts(int drops) {
  if (++programs_ > kMaxPrograms) return false;
  const std::optional<Core> found = core();
  if (!found) return false;
  if (drops == 0 || found->tiles == 0) return true;
  for (std::size_t k = 0; k < found->tiles; ++k) {
    left_out_[found->tile[k]] = 1;
    const bool still = contradicts(drops - 1);
    left_out_[found->tile[k]] = 0;
    if (!still) return false;
  }
  return true;
}

// Starts from the row with the least level and the faces of the box that cancel its gradient.
std::optional<JointProgram::Core> JointProgram::core() const {
  std::size_t first = rows_.size();
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    if (!is_out(rows_[n]) && (first == rows_.size() || rows_[n].level < rows_[first].level)) first = n;
  }
  if (first == rows_.size()) return std::nullopt;
  Basis basis;
  for (std::size_t k = 0; k < 3; ++k) {
    const double g = rows_[first].gradient[k] / scale_mm_, sign = g > 0.0 ? -1.0 : 1.0;
    basis.column[k] = 2 * k + (sign > 0.0 ? 0 : 1);
    basis.inverse[k][k] = sign;
    basis.inverse[k][3] = -sign * g;
    basis.multiplier[k] = std::abs(g);
    basis.cost[k] = 1.0;
  }
  basis.column[3] = Basis::kFaces + first;
  basis.inverse[3][3] = basis.multiplier[3] = 1.0;
  basis.cost[3] = rows_[first].level / scale_mm_;
  for (int k = 0; k < kMaxPivots; ++k) {
    if (!enter_best(basis)) break;
  }
  return verified(basis);
}

// Lets the row that lies lowest at the optimum so far enter the basis, or a face of the box.
bool JointProgram::enter_best(Basis& basis) const {
  const Column y = basis.prices();
  double least = -kWorthEntering;
  std::size_t best = 0;
  bool found = false;
  for (std::size_t face = 0; face < Basis::kFaces; ++face) {
    const double reduced = 1.0 - (face % 2 == 0 ? 1.0 : -1.0) * y[face / 2];
    if (reduced >= least) continue;
    least = reduced;
    best = face;
    found = true;
  }
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    const Row& row = rows_[n];
    if (is_out(row)) continue;
    const double value = row.level - (y[0] * row.gradient[0] + y[1] * row.gradient[1] + y[2] * row.gradient[2]);
    if (value / scale_mm_ - y[3] >= least) continue;
    least = value / scale_mm_ - y[3];
    best = Basis::kFaces + n;
    found = true;
  }
  if (!found) return false;
  Column a{};
  if (best < Basis::kFaces) {
    a[best / 2] = best % 2 == 0 ? 1.0 : -1.0;
    return basis.enter(best, a, 1.0);
  }
  const Row& row = rows_[best - Basis::kFaces];
  for (std::size_t k = 0; k < 3; ++k) a[k] = row.gradient[k] / scale_mm_;
  a[3] = 1.0;
  return basis.enter(best, a, row.level / scale_mm_);
}

// Adds up the constraints of the basis: whatever the point of the box, their weighted sum stays below 0.
std::optional<JointProgram::Core> JointProgram::verified(const Basis& basis) const {
  Core core;
  std::array<double, 3> rest{};
  double level = 0.0, size = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    const double multiplier = basis.multiplier[k];
    if (basis.column[k] < Basis::kFaces || !(multiplier > 0.0)) continue;
    const Row& row = rows_[basis.column[k] - Basis::kFaces];
    level += multiplier * row.level;
    size += multiplier * std::abs(row.level);
    for (std::size_t m = 0; m < 3; ++m) {
      rest[m] += multiplier * row.gradient[m];
      size += multiplier * std::abs(row.gradient[m]);
    }
    if (row.tile == kNoTile) continue;
    const auto end = core.tile.begin() + static_cast<std::ptrdiff_t>(core.tiles);
    if (std::find(core.tile.begin(), end, row.tile) == end) core.tile[core.tiles++] = row.tile;
  }
  const double highest = level + std::abs(rest[0]) + std::abs(rest[1]) + std::abs(rest[2]);
  if (!(highest + kRounding * size < 0.0)) return std::nullopt;
  return core;
}

}  // namespace triskin::placement
