// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "triskin/base/names.hpp"

namespace triskin::check {

using PlanePoint = std::array<double, 2>;
using Ring = std::vector<PlanePoint>;

/// A box of motions: low and high of x mm, y mm, theta rad.
struct ProofBox {
  std::array<double, 3> low{}, high{};
};

struct ProofTile {
  int i = 0, j = 0;
  bool up = true;
  auto operator<=>(const ProofTile&) const = default;
};

/// docs/placement.md gives the names of these shapes in the format.
enum class ProofShape { kTriangle, kSquare, kHexagon };
inline constexpr NameTable kProofShapeNames{std::array<std::pair<ProofShape, std::string_view>, 3>{
    {{ProofShape::kTriangle, "triangle"}, {ProofShape::kSquare, "square"}, {ProofShape::kHexagon, "hexagon"}}}};

struct ProofLog {
  std::vector<Ring> rings;
  /// The value is missing when the log names an unknown shape.
  std::optional<ProofShape> shape = ProofShape::kTriangle;
  PlanePoint pivot{};
  double pitch_mm = 0.0, tolerance_mm = 0.0;
  double corner_cut_mm = 0.0;  ///< A log without a corner cut has 0.
  int modules = 0, upper_bound = 0;
  std::array<double, 3> motion{};
  std::vector<ProofTile> tiles;
  std::vector<ProofBox> cells;
};

/// Reads a proof log. Errors: InputError naming `name` and the key for text that is no log of version 1.
[[nodiscard]] ProofLog read_proof_log(const std::string& text, const std::string& name);
/// Reads the rings of a GeoJSON or WKT polygon exactly as in the file. Errors: InputError naming `name`.
[[nodiscard]] std::vector<Ring> read_rings(const std::string& text, const std::string& name);

/// Returns the edges that bound the rings, each with its smaller end first, sorted; points are left out. The same
/// outline gives the same set, however its rings are turned, numbered and closed.
[[nodiscard]] std::vector<std::array<PlanePoint, 2>> edge_set(const std::vector<Ring>& rings);

}  // namespace triskin::check
