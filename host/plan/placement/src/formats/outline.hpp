// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "triskin/design/design_types.hpp"

namespace triskin::placement {

/// Arcs and curves become chords that are nowhere farther from them than this.
inline constexpr double kFlattening_mm = 0.01;
/// Ends of lines that are this near are one corner: drawings round their coordinates.
inline constexpr double kJoined_mm = 0.01;

/// Collects the curves of a drawing as chords, in mm with y up.
class Outline {
 public:
  explicit Outline(std::string name) : name_(std::move(name)) {}

  /// Begins a curve at a point.
  void move_to(const Vec2& p) { paths_.push_back({{p}, false}); }
  /// Continues the last curve; there must be one.
  void line_to(const Vec2& p) { paths_.back().points.push_back(p); }
  void close() { paths_.back().is_closed = true; }
  /// Where the last curve ends.
  [[nodiscard]] const Vec2& end() const { return paths_.back().points.back(); }
  /// Follows a curve `place(t)`, t from 0 (where the last one ends) to 1. `bend_mm` bounds the length of its second
  /// derivative, since the chord over h lies within h²/8 of that of it.
  template <class Place>
  void curve(const Place& place, double bend_mm);
  /// A cubic Bézier curve from the end of the last one.
  void cubic_to(const Vec2& a, const Vec2& b, const Vec2& p);
  /// An elliptic arc `middle + cos(t) u + sin(t) v`, t from `from_rad` over `sweep_rad`; it begins where the last curve
  /// ends, or is a curve of its own.
  void arc(const Vec2& middle, const Vec2& u, const Vec2& v, double from_rad, double sweep_rad, bool begins);

  /// The one polygon of the drawing: curves that meet are joined, the ring around all is the outline, rings in it are
  /// holes. Errors: InputError for no curve, for an open one (where, and how wide its gap is) and for several outlines.
  [[nodiscard]] Polygon polygon();

 private:
  struct Path {
    std::vector<Vec2> points;
    bool is_closed = false;
  };
  std::vector<std::vector<Vec2>> joined();

  std::string name_;
  std::vector<Path> paths_;
};

/// The outline of a drawing, and what its reader has to know about it, empty for nothing.
struct Drawing {
  Polygon polygon;
  std::string remark;
};

/// Reads the outline of a text DXF (lines, polylines with bulges, circles, arcs, ellipses, splines) in its unit
/// ($INSUNITS; mm without one, which the remark says), or in `unit_mm` where that is given. Layers that are off or
/// frozen, the layer Defpoints, invisible entities, paper space and annotations are left out, curves that leave a plane
/// z = constant refused. Errors: InputError naming `name` and the line.
[[nodiscard]] Drawing outline_of_dxf(const std::string& text, const std::string& name, std::optional<double> unit_mm);

/// Reads the outline of an SVG (paths and basic shapes with their transforms), in the unit of its width and viewBox (96
/// px an inch without both, which the remark says), or with user units of `unit_mm` where that is given, with y up.
/// What is not displayed or not painted is left out, also by a style sheet whose selectors are names of elements,
/// classes and ids. Other selectors, sheets that move, cut or name another file, clip paths, masks and entities are
/// refused. Errors: InputError naming `name` and the element.
[[nodiscard]] Drawing outline_of_svg(const std::string& text, const std::string& name, std::optional<double> unit_mm);

template <class Place>
void Outline::curve(const Place& place, double bend_mm) {
  constexpr double kMaxChords = 1e5;
  const double chords = std::clamp(std::ceil(std::sqrt(bend_mm / (8.0 * kFlattening_mm))), 1.0, kMaxChords);
  for (int k = 1; k <= static_cast<int>(chords); ++k) line_to(place(static_cast<double>(k) / chords));
}

}  // namespace triskin::placement
