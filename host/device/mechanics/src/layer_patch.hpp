// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>

#include "body.hpp"
#include "triskin/mechanics/layer.hpp"

namespace triskin::mechanics {

/// Describes the points of a patch of the layer: `columns` × `rows` of them, `spacing_mm` apart, centred on the
/// origin. Fields over it are arrays of that many rows and columns: entry (i, j) is at x(i), y(j).
struct PatchGrid {
  int points_x = 64, points_y = 64;
  double spacing_mm = 0.5;
  [[nodiscard]] double x(int i) const { return (i - points_x / 2) * spacing_mm; }
  [[nodiscard]] double y(int j) const { return (j - points_y / 2) * spacing_mm; }
};

/// A contact of any body, on the points of a patch.
struct PatchContact {
  PatchGrid grid;
  double force_n = 0.0, indentation_mm = 0.0, contact_area_mm2 = 0.0, peak_pressure_kpa = 0.0;
  Eigen::ArrayXXd pressure_kpa, displacement_mm, base_pressure_kpa;
  int iterations = 0;
};

/// Returns the height of the lower surface of a body above its lowest point on the patch, mm; infinite beside the body.
[[nodiscard]] Eigen::ArrayXXd gap_over(const Body& body, const PatchGrid& grid);

/// Presses a body with the given gap on the bonded layer: finds the pressure that is nowhere negative, adds up to
/// `force_n` and leaves gap + displacement equal where it acts. The layer's kernel is applied by FFT, and conjugate
/// gradients with the contact condition find the pressure; the depth is a result. Patches repeat without end, so a
/// contact within four thicknesses of the border is refused. A body that is flat from border to border cannot be
/// pressed. Throws InputError when a value is out of range, the contact is too near to the border, the body reaches the
/// base, or the iteration does not converge. Error: that of the grid, about 1 % in contact radius and 0.1 % in
/// displacement at eight points per contact radius. Cost: two transforms per iteration, 20 … 60 iterations; 20 … 80
/// ms for 64². Thread-safe. Source: Polonsky and Keer, Wear 231 (1999) 206; Stanley and Kato, J. Tribol. 119 (1997)
/// 481.
[[nodiscard]] PatchContact press_on_patch(const Layer& layer, const PatchGrid& grid, const Eigen::ArrayXXd& gap_mm,
                                          double force_n);

/// Does the same on a patch that is chosen for the body: it grows until it contains the contact. Throws InputError as
/// press_on_patch() does.
[[nodiscard]] PatchContact press_body(const Layer& layer, const Body& body, double force_n, double spacing_mm);

/// Returns the displacement at a point in mm, by cubic interpolation between the patch's points; 0 outside.
[[nodiscard]] double displacement_mm(const PatchContact& contact, const Eigen::Vector2d& position_mm);

/// Returns the relative change of capacitance of a disc electrode centred at `position_mm`, as in taxel.hpp.
[[nodiscard]] double taxel_dc_over_c(const Layer& layer, const PatchContact& contact,
                                     const Eigen::Vector2d& position_mm, double disc_diameter_mm = 4.0);

}  // namespace triskin::mechanics
