// SPDX-License-Identifier: GPL-3.0-or-later
#include "block_solid.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace triskin::testing {
namespace {

using design::Vec3;

std::size_t at(int k) {
  return static_cast<std::size_t>(k);
}

// Numbers vertices by their place in the grid; across the period the first column is the last.
class Corners {
 public:
  Corners(WalledPart& part, const std::array<std::vector<double>, 3>& grid, const BlockSolid::Bend& bend, bool wraps)
      : part_(part), grid_(grid), bend_(bend), wraps_(wraps) {}

  int operator()(std::array<int, 3> k) {
    if (wraps_ && k[0] + 1 == static_cast<int>(grid_[0].size())) k[0] = 0;
    const auto [entry, is_new] = number_.emplace(k, static_cast<int>(part_.mesh.vertices.size()));
    if (is_new) part_.mesh.vertices.push_back(bend_(place(k)));
    return entry->second;
  }
  [[nodiscard]] Vec3 place(const std::array<int, 3>& k) const {
    return {grid_[0][at(k[0])], grid_[1][at(k[1])], grid_[2][at(k[2])]};
  }

 private:
  WalledPart& part_;
  const std::array<std::vector<double>, 3>& grid_;
  const BlockSolid::Bend& bend_;
  bool wraps_;
  std::map<std::array<int, 3>, int> number_;
};

}  // namespace

std::vector<double> BlockSolid::lines(int axis) const {
  std::vector<double> ends;
  for (const Block& b : blocks_) {
    ends.push_back(b.low[axis]);
    ends.push_back(b.high[axis]);
  }
  std::ranges::sort(ends);
  ends.erase(std::unique(ends.begin(), ends.end(), [](double a, double b) { return b - a < 1e-9; }), ends.end());
  std::vector<double> result{ends.front()};
  for (std::size_t k = 1; k < ends.size(); ++k) {
    const int parts = std::max(1, static_cast<int>(std::ceil((ends[k] - ends[k - 1]) / step_mm_ - 1e-9)));
    for (int p = 1; p <= parts; ++p) result.push_back(ends[k - 1] + (ends[k] - ends[k - 1]) * p / parts);
  }
  return result;
}

bool BlockSolid::is_solid(const Vec3& p) const {
  bool solid = false;
  for (const Block& b : blocks_) {
    if ((p.array() > b.low.array()).all() && (p.array() < b.high.array()).all()) solid = b.is_solid;
  }
  return solid;
}

void BlockSolid::append_to(WalledPart& part, const Bend& bend, const SideRule& side) const {
  const std::array<std::vector<double>, 3> grid{lines(0), lines(1), lines(2)};
  Corners corner(part, grid, bend, period_mm_ > 0.0);
  const auto cells = [&](int axis) { return static_cast<int>(grid[at(axis)].size()) - 1; };
  const auto solid = [&](std::array<int, 3> k) {
    if (period_mm_ > 0.0) k[0] = (k[0] + cells(0)) % cells(0);
    for (int axis = 0; axis < 3; ++axis) {
      if (k[at(axis)] < 0 || k[at(axis)] >= cells(axis)) return false;
    }
    return is_solid(0.5 * (corner.place(k) + corner.place({k[0] + 1, k[1] + 1, k[2] + 1})));
  };
  const auto add_quad = [&](const std::array<int, 3>& k, int axis, int way) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::array<std::array<int, 3>, 4> q{k, k, k, k};
    for (auto& c : q) c[at(axis)] += way > 0 ? 1 : 0;
    ++q[1][at(u)];
    ++q[2][at(u)];
    ++q[2][at(v)];
    ++q[3][at(v)];
    if (way < 0) std::swap(q[1], q[3]);
    Vec3 normal = Vec3::Zero();
    normal[axis] = way;
    const int label = side(0.5 * (corner.place(q[0]) + corner.place(q[2])), normal);
    const std::array<int, 4> n{corner(q[0]), corner(q[1]), corner(q[2]), corner(q[3])};
    part.mesh.faces.push_back({n[0], n[1], n[2]});
    part.mesh.faces.push_back({n[0], n[2], n[3]});
    part.side.insert(part.side.end(), 2, label);
  };
  for (int i = 0; i < cells(0); ++i) {
    for (int j = 0; j < cells(1); ++j) {
      for (int k = 0; k < cells(2); ++k) {
        if (!solid({i, j, k})) continue;
        for (int axis = 0; axis < 3; ++axis) {
          for (const int way : {-1, 1}) {
            std::array<int, 3> beyond{i, j, k};
            beyond[at(axis)] += way;
            if (!solid(beyond)) add_quad({i, j, k}, axis, way);
          }
        }
      }
    }
  }
}

}  // namespace triskin::testing
