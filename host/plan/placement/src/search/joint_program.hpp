// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace triskin::placement {

/// Shows by linear programs that tiles cannot hold together at any point of the box |u[k]| <= 1.
///
/// By Helly's theorem, half spaces of three variables that have no common point contain four that have none, so the
/// tiles of these four are a core of which at least one is left out. Leaving out each of them in turn, as often as
/// allowed, answers whether enough tiles hold together. The contradiction of a core is verified by the sum of its
/// constraints, whose multipliers the program gives, and never follows from the program alone. Keeps its memory, so
/// each thread needs its own object.
class JointProgram {
 public:
  static constexpr std::uint32_t kNoTile = 0xffffffff;

  /// Forgets all constraints. `tiles` is the number of tiles to which they belong.
  void begin(std::size_t tiles);
  /// Requires level + gradient·u >= 0, in mm, of a tile, or of the box itself (kNoTile).
  void add(std::uint32_t tile, const std::array<double, 3>& gradient, double level);
  /// Returns true if the tiles contradict each other whichever `drops` of them are left out. False may also
  /// mean that too many programs would have to be solved. Cost: up to 90 programs, each O(constraints) per step.
  [[nodiscard]] bool contradictory(int drops);

 private:
  struct Row {
    std::uint32_t tile;
    std::array<double, 3> gradient;
    double level;
  };
  // Tiles that cannot all hold.
  struct Core {
    std::array<std::uint32_t, 4> tile{};
    std::size_t tiles = 0;
  };
  using Column = std::array<double, 4>;
  struct Basis;
  [[nodiscard]] bool contradicts(int drops);
  [[nodiscard]] std::optional<Core> core() const;
  [[nodiscard]] bool is_out(const Row& row) const { return row.tile != kNoTile && left_out_[row.tile] != 0; }
  [[nodiscard]] bool enter_best(Basis& basis) const;
  [[nodiscard]] std::optional<Core> verified(const Basis& basis) const;

  std::vector<Row> rows_;
  std::vector<std::uint8_t> left_out_;
  double scale_mm_ = 0.0;  // The largest gradient makes the program's numbers about 1.
  int programs_ = 0;
};

}  // namespace triskin::placement
