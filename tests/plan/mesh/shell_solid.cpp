// SPDX-License-Identifier: GPL-3.0-or-later
#include "shell_solid.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace triskin::testing {
namespace {

using design::Vec3;

class Builder {
 public:
  Builder(const ShellSolid& s, WalledPart& part) : s_(s), part_(part) {}

  void run() {
    for (std::size_t layer = 0; layer < 2; ++layer) {
      first_[layer] = count();
      for (int i = 0; i < columns(); ++i) {
        for (int j = 0; j <= s_.rows; ++j) part_.mesh.vertices.push_back(place(i, j, layer == 0 ? 0.5 : -0.5));
      }
    }
    for (int i = 0; i < s_.columns; ++i) {
      for (int j = 0; j < s_.rows; ++j) {
        quad(vertex(0, i, j), vertex(0, i + 1, j), vertex(0, i + 1, j + 1), vertex(0, i, j + 1), 1);
        quad(vertex(1, i, j), vertex(1, i, j + 1), vertex(1, i + 1, j + 1), vertex(1, i + 1, j), -1);
      }
    }
    if (s_.wraps) {
      add_rim(s_.columns, true, [&](int k) { return std::array{s_.columns - k, s_.rows}; });
      add_rim(s_.columns, true, [](int k) { return std::array{k, 0}; });
    } else {
      add_rim(2 * (s_.columns + s_.rows), true, [&](int k) { return around(k); });
    }
  }

 private:
  [[nodiscard]] int count() const { return static_cast<int>(part_.mesh.vertices.size()); }
  [[nodiscard]] int columns() const { return s_.wraps ? s_.columns : s_.columns + 1; }
  [[nodiscard]] int vertex(std::size_t layer, int i, int j) const {
    return first_[layer] + (i % columns()) * (s_.rows + 1) + j;
  }
  [[nodiscard]] Vec3 at(int i, int j) const {
    return s_.sheet(static_cast<double>(i) / s_.columns, static_cast<double>(j) / s_.rows);
  }
  [[nodiscard]] double wall(int i, int j) const {
    return s_.wall_mm(static_cast<double>(i) / s_.columns, static_cast<double>(j) / s_.rows);
  }
  [[nodiscard]] Vec3 along(int i, int j, bool u) const {
    constexpr double kStep = 1e-5;
    const double a = static_cast<double>(i) / s_.columns, b = static_cast<double>(j) / s_.rows;
    return u ? s_.sheet(a + kStep, b) - s_.sheet(a - kStep, b) : s_.sheet(a, b + kStep) - s_.sheet(a, b - kStep);
  }
  [[nodiscard]] Vec3 normal(int i, int j) const { return along(i, j, true).cross(along(i, j, false)).normalized(); }
  [[nodiscard]] Vec3 place(int i, int j, double height) const { return at(i, j) + height * wall(i, j) * normal(i, j); }
  // The order is counter-clockwise, seen from outside.
  [[nodiscard]] std::array<int, 2> around(int k) const {
    k %= 2 * (s_.columns + s_.rows);
    if (k < s_.columns) return {k, 0};
    k -= s_.columns;
    if (k < s_.rows) return {s_.columns, k};
    k -= s_.rows;
    if (k < s_.columns) return {s_.columns - k, s_.rows};
    return {0, s_.rows - (k - s_.columns)};
  }

  template <class Path>
  void add_rim(int steps, bool is_loop, Path path) {
    std::vector<std::vector<int>> rows;
    for (int k = 0; k < steps; ++k) {
      const auto [i, j] = path(k);
      std::vector<int> row{vertex(0, i, j)};
      for (int r = 1; r < s_.rim_facets; ++r) {
        const double angle = std::numbers::pi * r / s_.rim_facets;
        const Vec3 out = outward(path((k + steps - 1) % steps), path(k), path((k + 1) % steps));
        row.push_back(count());
        part_.mesh.vertices.push_back(place(i, j, 0.5 * std::cos(angle)) + 0.5 * wall(i, j) * std::sin(angle) * out);
      }
      row.push_back(vertex(1, i, j));
      rows.push_back(row);
    }
    for (int k = 0; is_loop && k < steps; ++k) {
      const auto &a = rows[static_cast<std::size_t>(k)], &b = rows[static_cast<std::size_t>((k + 1) % steps)];
      for (std::size_t r = 0; r + 1 < a.size(); ++r) quad(a[r + 1], b[r + 1], b[r], a[r], 0);
    }
  }
  [[nodiscard]] Vec3 outward(std::array<int, 2> before, std::array<int, 2> here, std::array<int, 2> after) const {
    const Vec3 way = at(after[0], after[1]) - at(before[0], before[1]);
    return way.cross(normal(here[0], here[1])).normalized();
  }

  void quad(int a, int b, int c, int d, int side) {
    part_.mesh.faces.push_back({a, b, c});
    part_.mesh.faces.push_back({a, c, d});
    part_.side.insert(part_.side.end(), 2, side);
  }

  const ShellSolid& s_;
  WalledPart& part_;
  std::array<int, 2> first_{};
};

}  // namespace

void ShellSolid::append_to(WalledPart& part) const {
  Builder(*this, part).run();
}

}  // namespace triskin::testing
