// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "motion_region.hpp"

namespace triskin::check {

/// A need with its module, and its rounded excess over the region: excess + Σ change[k]·u[k], |u[k]| ≤ 1.
struct CoreNeed {
  std::size_t module = 0;
  const Need* need = nullptr;
  double excess_mm = 0.0;
  std::array<double, 3> change_mm{};
};

/// Shows that modules never lie inside together, by needs of up to four of them whose weighted sum stays below 0 over
/// the whole region. Where a region has more modules than may be left out, each module of such a core is left out in
/// turn. The needs and weights come from rounded numbers; only the sum in interval arithmetic proves. Each thread needs
/// its own object.
class CoreSearch {
 public:
  CoreSearch(const MotionRegion& region, std::size_t modules) : region_(region), left_out_(modules, false) {}

  /// The need must outlive the search.
  void add(std::size_t module, const Need& need);
  /// Returns true if the modules never lie inside together, whichever `drops` of them are left out. False proves
  /// nothing. Cost: at most 90 searches for a core, each O(needs) per exchange.
  [[nodiscard]] bool contradictory(int drops);

 private:
  // Four constraints, needs or faces of the region, whose weighted sum does not change with the motion.
  struct Corner {
    std::array<std::size_t, 4> row{};
    std::array<double, 4> weight{};
    std::array<double, 4> lowest{};  // The motion u at which the four are equal, and their value there.
  };
  using Column = std::array<double, 4>;
  [[nodiscard]] bool contradicts(int drops);
  [[nodiscard]] std::optional<std::vector<std::size_t>> core() const;
  [[nodiscard]] std::optional<Corner> first_corner() const;
  [[nodiscard]] std::optional<Corner> next_corner(const Corner& corner) const;
  [[nodiscard]] std::optional<Corner> corner_of(const std::array<std::size_t, 4>& rows) const;
  [[nodiscard]] Column column(std::size_t row) const;
  [[nodiscard]] double value_at(std::size_t row, const std::array<double, 4>& place) const;
  [[nodiscard]] std::size_t rows() const;
  [[nodiscard]] bool is_out(std::size_t row) const;
  [[nodiscard]] bool never_met(const Corner& corner) const;

  const MotionRegion& region_;
  std::vector<CoreNeed> needs_;
  std::vector<bool> left_out_;
  double scale_mm_ = 1e-300;
  int searches_ = 0;
};

}  // namespace triskin::check
