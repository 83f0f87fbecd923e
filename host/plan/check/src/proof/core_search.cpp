// SPDX-License-Identifier: GPL-3.0-or-later
#include "core_search.hpp"

#include <algorithm>
#include <cmath>

namespace triskin::check {
namespace {

constexpr int kMaxSearches = 90, kMaxExchanges = 60;
constexpr std::size_t kFaces = 6;  // Before the needs come the faces of the region: 1 − u[k] and 1 + u[k].
constexpr double kLower = 1e-9, kFlat = 1e-11, kMinWeight = -1e-6;

using Square = std::array<std::array<double, 5>, 4>;  // Four equations, each with its right side.

// Solves four equations by elimination; returns nothing if they are nearly dependent.
std::optional<std::array<double, 4>> solved(Square m) {
  for (std::size_t k = 0; k < 4; ++k) {
    std::size_t largest = k;
    for (std::size_t r = k + 1; r < 4; ++r) {
      if (std::abs(m[r][k]) > std::abs(m[largest][k])) largest = r;
    }
    if (std::abs(m[largest][k]) < kFlat) return std::nullopt;
    std::swap(m[k], m[largest]);
    for (std::size_t r = 0; r < 4; ++r) {
      if (r == k) continue;
      const double share = m[r][k] / m[k][k];
      for (std::size_t c = k; c < 5; ++c) m[r][c] -= share * m[k][c];
    }
  }
  return std::array{m[0][4] / m[0][0], m[1][4] / m[1][1], m[2][4] / m[2][2], m[3][4] / m[3][3]};
}

}  // namespace

void CoreSearch::add(std::size_t module, const Need& need) {
  const NeedChange change = region_.change(need);
  needs_.push_back({module, &need, change.excess_mm, change.by_u_mm});
  for (const double c : change.by_u_mm) scale_mm_ = std::max(scale_mm_, std::abs(c));
}

bool CoreSearch::contradictory(int drops) {
  searches_ = 0;
  return contradicts(drops);
}

bool CoreSearch::contradicts(int drops) {
  if (++searches_ > kMaxSearches) return false;
  const auto modules = core();
  if (!modules) return false;
  if (drops == 0) return true;
  for (const std::size_t module : *modules) {
    left_out_[module] = true;
    const bool still = contradicts(drops - 1);
    left_out_[module] = false;
    if (!still) return false;
  }
  return true;
}

std::size_t CoreSearch::rows() const {
  return kFaces + needs_.size();
}

bool CoreSearch::is_out(std::size_t row) const {
  return row >= kFaces && left_out_[needs_[row - kFaces].module];
}

// Returns gradient and constant part of a row, in units of the largest change; a face never lies below the value that
// is sought, so that its last entry, by which that value counts, is 0.
CoreSearch::Column CoreSearch::column(std::size_t row) const {
  Column c{};
  if (row < kFaces) {
    c[row / 2] = row % 2 == 0 ? -1.0 : 1.0;
    return c;
  }
  for (std::size_t k = 0; k < 3; ++k) c[k] = needs_[row - kFaces].change_mm[k] / scale_mm_;
  c[3] = 1.0;
  return c;
}

double CoreSearch::value_at(std::size_t row, const std::array<double, 4>& place) const {
  const Column c = column(row);
  const double constant = row < kFaces ? 1.0 : needs_[row - kFaces].excess_mm / scale_mm_;
  return constant + c[0] * place[0] + c[1] * place[1] + c[2] * place[2] - c[3] * place[3];
}

// Solves for the weights, whose sum over needs is 1 and which cancel all gradients, and for the motion.
std::optional<CoreSearch::Corner> CoreSearch::corner_of(const std::array<std::size_t, 4>& rows) const {
  Square for_weights{}, for_place{};
  for (std::size_t n = 0; n < 4; ++n) {
    const Column c = column(rows[n]);
    for (std::size_t k = 0; k < 4; ++k) {
      for_weights[k][n] = c[k];
      for_place[n][k] = k < 3 ? c[k] : -c[k];
    }
    for_place[n][4] = rows[n] < kFaces ? -1.0 : -needs_[rows[n] - kFaces].excess_mm / scale_mm_;
  }
  for_weights[3][4] = 1.0;
  const auto weight = solved(for_weights), place = solved(for_place);
  if (!weight || !place) return std::nullopt;
  if (std::ranges::any_of(*weight, [](double w) { return w < kMinWeight; })) return std::nullopt;
  return Corner{rows, *weight, *place};
}

std::optional<CoreSearch::Corner> CoreSearch::first_corner() const {
  std::size_t least = rows();
  for (std::size_t row = kFaces; row < rows(); ++row) {
    if (is_out(row)) continue;
    if (least == rows() || needs_[row - kFaces].excess_mm < needs_[least - kFaces].excess_mm) least = row;
  }
  if (least == rows()) return std::nullopt;
  const Column c = column(least);
  std::array<std::size_t, 4> rows{0, 0, 0, least};
  for (std::size_t k = 0; k < 3; ++k) rows[k] = 2 * k + (c[k] > 0.0 ? 0 : 1);
  return corner_of(rows);
}

// Exchanges one row for the one that lies lowest at the corner. Returns nothing if none lies lower than the corner.
std::optional<CoreSearch::Corner> CoreSearch::next_corner(const Corner& corner) const {
  double least = -kLower;
  std::size_t lowest = rows();
  for (std::size_t row = 0; row < rows(); ++row) {
    if (is_out(row)) continue;
    const double value = value_at(row, corner.lowest);
    if (value >= least) continue;
    least = value;
    lowest = row;
  }
  if (lowest == rows()) return std::nullopt;
  std::optional<Corner> best;
  for (std::size_t k = 0; k < 4; ++k) {
    std::array<std::size_t, 4> exchanged = corner.row;
    exchanged[k] = lowest;
    const auto next = corner_of(exchanged);
    if (next && (!best || std::ranges::min(next->weight) > std::ranges::min(best->weight))) best = next;
  }
  return best && best->lowest[3] <= corner.lowest[3] + kLower ? best : std::nullopt;
}

std::optional<std::vector<std::size_t>> CoreSearch::core() const {
  std::optional<Corner> corner = first_corner();
  for (int k = 0; corner && k < kMaxExchanges; ++k) {
    const std::optional<Corner> next = next_corner(*corner);
    if (!next) break;
    corner = next;
  }
  if (!corner || !(corner->lowest[3] < 0.0) || !never_met(*corner)) return std::nullopt;
  std::vector<std::size_t> modules;
  for (const std::size_t row : corner->row) {
    if (row >= kFaces && std::ranges::find(modules, needs_[row - kFaces].module) == modules.end())
      modules.push_back(needs_[row - kFaces].module);
  }
  return modules;
}

bool CoreSearch::never_met(const Corner& corner) const {
  std::vector<WeightedNeed> sum;
  for (std::size_t k = 0; k < 4; ++k) {
    if (corner.row[k] >= kFaces && corner.weight[k] > 0.0)
      sum.push_back({needs_[corner.row[k] - kFaces].need, corner.weight[k]});
  }
  return region_.never_met_together(sum);
}

}  // namespace triskin::check
