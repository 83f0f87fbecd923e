// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <filesystem>
#include <vector>

#include "triskin/design/design_types.hpp"

namespace triskin::placement {

/// Weighs a module by the place of its centre on the polygon (contact likelihood): a uniform cubic B-spline over a
/// raster, so that it is smooth (C²), lies between the raster's least and largest value, and has bounds for its
/// slopes. Outside the raster its rim continues. Immutable, so any number of threads may read it.
class WeightMap {
 public:
  /// values[row][column], 0 … 1e12, belongs to origin + step·(column, row), mm in the frame of the polygon; below
  /// 1e-300 a value counts as 0. Errors: InputError for rows of different lengths, values out of range, a step that is
  /// not positive, no values.
  WeightMap(const Vec2& origin_mm, double step_mm, const std::vector<std::vector<double>>& values);

  /// A vertex of of_mesh(): place on the polygon and weight, 0 … 1e12.
  struct Vertex {
    Vec2 at_mm;
    double weight = 0.0;
  };
  /// Makes the map from a flat mesh with a weight at each vertex (an unfolded cover), linear on its faces; elsewhere
  /// the weight is that of the nearest point of a face. Cost: raster points in the box of the mesh, each against every
  /// face. Errors: as above, and for faces with vertices that do not exist, no face, or a step that gives too many
  /// points.
  [[nodiscard]] static WeightMap of_mesh(const std::vector<Vertex>& vertices,
                                         const std::vector<std::array<int, 3>>& faces, double step_mm);

  /// A jet has the value and the gradient of the map at a point, and an upper bound of the second derivative in every
  /// direction within step_mm() of it.
  struct Jet {
    double value = 0.0;
    Vec2 slope_per_mm = Vec2::Zero();
    double near_curvature_per_mm2 = 0.0;
  };
  /// Returns value and gradient at a point in the frame of the polygon, mm; any finite point is allowed. Constant cost.
  [[nodiscard]] Jet at(const Vec2& p_mm) const;
  /// Returns the distance of two rows or columns of the raster.
  [[nodiscard]] double step_mm() const { return step_; }
  /// Returns an upper bound of all values.
  [[nodiscard]] double most() const { return most_; }
  /// Returns an upper bound of the length of the gradient, per mm.
  [[nodiscard]] double max_slope_per_mm() const { return max_slope_; }
  /// Returns an upper bound of the second derivative in every direction, per mm².
  [[nodiscard]] double max_curvature_per_mm2() const { return max_curvature_; }

 private:
  // Control values are kept up to this many steps outside the raster, where they are those of its rim.
  static constexpr int kRim = 6;
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row + kRim) * static_cast<std::size_t>(stride_) +
           static_cast<std::size_t>(column + kRim);
  }
  [[nodiscard]] const double* control(int column, int row) const { return control_.data() + index(column, row); }
  [[nodiscard]] double curvature_around(int column, int row) const;

  Vec2 origin_;
  double step_;
  int columns_ = 0, rows_ = 0, stride_ = 0;
  std::vector<double> control_;
  std::vector<double> near_curvature_;  // Each square of the raster has the bound for itself and those around it.
  double most_ = 0.0, max_slope_ = 0.0, max_curvature_ = 0.0;
};

/// Reads {"origin_mm": [x, y], "step_mm": s, "rows": [[…], …]}, rows upwards, or {"step_mm": s, "vertices": [[x, y,
/// weight], …], "faces": [[a,b,c], …]}, or {"step_mm": s, "elsewhere": w, "module_weight":w, "regions": [{"weight":
/// w, "outline_mm": [[x, y], …]}, …]} (weight_regions.hpp; module_weight: optional). Errors: InputError with file,
/// path and cause when it cannot be read or has another key, or as of the constructors.
[[nodiscard]] WeightMap read_weight_map(const std::filesystem::path& file);

}  // namespace triskin::placement
