// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <random>

namespace triskin {

/// Draws the random numbers of the solvers: a seed gives the same sequence on every compiler and machine (the
/// distributions of the standard library do not). Each thread needs its own object.
class Dice {
 public:
  /// Any seed is allowed; equal seeds give equal sequences.
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  /// Draws uniformly from 0 … n − 1 as the remainder of a draw; n ≥ 1. Routing and random patches draw this way.
  [[nodiscard]] int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
  /// Draws uniformly from [0, 1), in steps of 2⁻⁵³.
  [[nodiscard]] double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  /// Draws uniformly from 0 … n - 1 as ⌊n * unit()⌋; n >= 1. The lattice on the surface draws this way. A seed
  /// stands for a design, so neither way may replace the other.
  [[nodiscard]] int scaled_below(int n) { return static_cast<int>(unit() * n); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace triskin
