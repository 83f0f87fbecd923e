// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <map>
#include <random>
#include <vector>

#include "triskin/geometry/module_layout.hpp"
#include "triskin/geometry/surface.hpp"

namespace triskin::geometry {

/// Grows one layout. Not thread-safe; the surface is shared.
class Grower {
 public:
  using Deadline = std::chrono::steady_clock::time_point;
  Grower(const Surface& surface, const std::vector<double>& area_sums, const LayoutLimits& limits, std::uint64_t seed);

  /// Islands until nothing more fits; stops early at the deadline.
  void grow(Deadline deadline);
  /// Takes the modules within `radius_mm` of a random one away and grows there anew; undone when the score falls by more than
  /// `allowed_loss`. Score: modules − island_cost · islands.
  void ruin_and_recreate(double radius_mm, double allowed_loss, double island_cost, Deadline deadline);
  [[nodiscard]] double score(double island_cost) const { return static_cast<double>(modules_.size()) - island_cost * islands_; }
  [[nodiscard]] const std::vector<PlacedModule>& modules() const { return modules_; }
  [[nodiscard]] int islands() const { return islands_; }

 private:
  struct Side {
    int module, side;
  };
  double uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  bool seed_island(const Vec3& middle);
  [[nodiscard]] Vec3 random_point();
  void keep(const std::vector<bool>& kept);
  void grow_island(Deadline deadline);
  bool add_across(const Side& at);
  [[nodiscard]] std::array<Vec3, 3> roll(const PlacedModule& from, int side) const;
  [[nodiscard]] int find(int island, const Tile& tile) const;
  void join(int a, int side);
  void part(int a, int side);
  [[nodiscard]] std::vector<int> neighbourhood(int center) const;
  void relax(const std::vector<int>& members, int steps);
  [[nodiscard]] Vec3 pulled_corner(const PlacedModule& m, int corner) const;
  bool open_bad_joints(const std::vector<int>& members, int added);
  [[nodiscard]] bool holds(const std::vector<int>& members) const;
  [[nodiscard]] bool holds_alone(const PlacedModule& m) const;
  [[nodiscard]] int closings(const Side& at) const;

  const Surface& surface_;
  const std::vector<double>& area_sums_;
  LayoutLimits limits_;
  std::mt19937_64 random_;
  std::vector<PlacedModule> modules_;
  std::map<std::pair<int, Tile>, int> place_;
  std::vector<Side> open_;
  int islands_ = 0;
};

}  // namespace triskin::geometry
