// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <utility>

#include "triskin/base/names.hpp"

namespace triskin::design {

enum class JumperKind {
  kCable,  ///< A short cable joins the middles of two sides.
};
/// The design file uses these names: "cable".
inline constexpr NameTable kJumperKindNames{
    std::array<std::pair<JumperKind, std::string_view>, 1>{{{JumperKind::kCable, "cable"}}}};

/// A jumper joins sides of modules of two islands by a short cable along the surface. It carries the four lines like a
/// joint of the lattice. A side has at most one jumper and then neither a joint nor an entry cable; two modules share
/// at most one jumper. Nodes are those of ModuleGraph, in a design module ids.
struct Jumper {
  std::array<int, 2> node{-1, -1};  ///< The smaller node is listed first.
  std::array<int, 2> side{0, 0};    ///< Each side is a tile side, 0 … 2.
  double length_mm = 0.0;           ///< The length is measured along the surface between the middles of the sides.
  double fold_rad = 0.0;            ///< The fold is the angle between the planes of the two modules.
  JumperKind kind = JumperKind::kCable;
};

}  // namespace triskin::design
