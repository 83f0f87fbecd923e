// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <utility>

#include "triskin/base/names.hpp"

namespace triskin::design {

/// Way in which a jumper is built.
enum class JumperKind {
  kCable,  ///< A short cable joins the middles of two sides.
};
/// Names in the design file: "cable".
inline constexpr NameTable kJumperKindNames{
    std::array<std::pair<JumperKind, std::string_view>, 1>{{{JumperKind::kCable, "cable"}}}};

/// A joint between sides of modules of two islands, made by a short cable along the surface. It carries the four lines
/// like a joint of the lattice. A side has at most one jumper and then no joint and no entry cable; two modules have at
/// most one. Nodes as in ModuleGraph: in a design module ids.
struct Jumper {
  std::array<int, 2> node{-1, -1};  ///< The lesser one comes first.
  std::array<int, 2> side{0, 0};    ///< It is the tile side, 0 … 2, of each.
  double length_mm = 0.0;           ///< It is measured along the surface between the middles of the sides.
  double fold_rad = 0.0;            ///< It is the angle between the planes of the two modules.
  JumperKind kind = JumperKind::kCable;
};

}  // namespace triskin::design
