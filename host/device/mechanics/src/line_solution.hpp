// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>

#include "quadrature.hpp"

namespace triskin::mechanics {

// Solves a line contact of half width a on the bonded layer in plane strain; units as in radial_solution.hpp. The
// pressure is Σ bₙ T₂ₙ(x/a) / √(1 − (x/a)²). The kernel −ln|x| is diagonal in these polynomials, and the
// layer adds a smooth term (Jaffar, Int. J. Mech. Sci. 31 (1989) 229 solves the same equation).

/// Solves the contact under the parabola x² / 2 · curvature that presses with no pressure at its edges.
class LineSolution {
 public:
  LineSolution(double poisson, double half_width, double curvature);
  /// Returns the force per length.
  [[nodiscard]] double force() const;
  [[nodiscard]] double indentation() const { return indentation_; }
  [[nodiscard]] double centre_pressure() const;
  /// Returns the displacement at distance x outside the contact, up to half_width + 25.
  [[nodiscard]] double displacement_outside(double x) const;
  [[nodiscard]] double base_pressure(double x) const;

 private:
  [[nodiscard]] double smooth_part(double x) const;

  double half_width_, indentation_ = 0.0;
  Eigen::VectorXd coefficients_;
  // The nodes lie in −a … a; the other array has pressure times weight there.
  Eigen::ArrayXd points_, weighted_pressure_;
  Quadrature spectrum_;
  Eigen::ArrayXd smooth_terms_, base_terms_;
};

}  // namespace triskin::mechanics
