// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/LU>
#include <functional>

#include "quadrature.hpp"

namespace triskin::mechanics {

// Solves an axisymmetric contact of radius a on the bonded layer. Lengths are in thicknesses of the layer, pressures in
// E / (2(1 − ν²)), so that only ν and a remain.
//
// The transform of the pressure is p̂(k) = ∫₀ᵃ g(t) cos(kt) dt. Abel's inversion of "displacement = δ − gap
// for r < a" (Lebedev and Ufliand, PMM 22 (1958) 442) leaves a Fredholm equation of the second kind with a smooth
// kernel: g(t) − 2/π ∫₀ᵃ g(s) ∫₀^∞ N(k) cos(kt) cos(ks) dk ds = 2/π · (δ − G(t)), G(t) = d/dt
// ∫₀ᵗ r·gap(r) / √(t² − r²) dr, where N = 1 − compliance_ratio. Gauss nodes in t and k solve it to
// about ten digits.

/// Describes the gap of an indenter: gap(r), G(t) as above, and G′(t) / t.
struct RadialGap {
  std::function<double(double)> gap, abel, abel_slope_over_t;
};

[[nodiscard]] RadialGap sphere_gap(double radius);
[[nodiscard]] RadialGap paraboloid_gap(double radius);
[[nodiscard]] RadialGap flat_gap();
/// Returns the gap (r / contact_radius)^(2 · power); power 1, 2 or 3.
[[nodiscard]] RadialGap monomial_gap(int power, double contact_radius);

/// Gives the density g of a pressure at the nodes of the system and at the edge.
struct RadialDensity {
  Eigen::ArrayXd values;
  double edge = 0.0;
};

/// Discretizes the equation for one contact radius. Cost: some (4a + 32)² · (20a + 200) operations once.
class RadialSystem {
 public:
  RadialSystem(double poisson, double contact_radius);
  /// Solves for the right-hand side δ − G; the solution is linear in both.
  [[nodiscard]] RadialDensity solve(double indentation, const RadialGap& gap) const;
  /// Solves with the indentation at which the pressure at the edge is finite; that indentation is an output.
  [[nodiscard]] RadialDensity solve_smooth(const RadialGap& gap, double& indentation) const;
  /// Returns the pressure in the centre; `sine_sums` is sine_sums(), which several densities share.
  [[nodiscard]] double centre_pressure(const RadialDensity& density, const RadialGap& gap,
                                       const Eigen::ArrayXd& sine_sums) const;
  [[nodiscard]] Eigen::ArrayXd sine_sums() const;
  [[nodiscard]] double force(const RadialDensity& density) const;
  [[nodiscard]] const Quadrature& nodes() const { return nodes_; }
  [[nodiscard]] double contact_radius() const { return contact_radius_; }
  [[nodiscard]] double poisson() const { return poisson_; }

 private:
  // Returns ∫ g cos(kt) dt times the deficit and the weight of each wave number.
  [[nodiscard]] Eigen::ArrayXd deficit_transform(const RadialDensity& density) const;

  double poisson_, contact_radius_;
  Quadrature nodes_, spectrum_;
  Eigen::MatrixXd cosines_;  // Rows are wave numbers, columns are nodes.
  Eigen::ArrayXd deficit_;   // Entries are N times the weights of the spectrum.
  Eigen::PartialPivLU<Eigen::MatrixXd> factors_;
};

/// Holds the wave numbers for fields up to a distance, with the kernels there; densities of one system share it.
struct FieldSpectrum {
  FieldSpectrum(const RadialSystem& system, double reach);
  Quadrature rule;
  Eigen::MatrixXd cosines;
  Eigen::ArrayXd deficit, base;  // Entries are kernels times weights.
};

/// Evaluates the fields of a density, for distances up to the reach of the spectrum.
class RadialField {
 public:
  RadialField(const RadialSystem& system, RadialDensity density, const FieldSpectrum& spectrum);
  /// Returns the displacement at r outside the contact; inside it is δ − gap.
  [[nodiscard]] double displacement_outside(double r) const;
  [[nodiscard]] double base_pressure(double r) const;
  /// Returns the displacement outside on a half-space; displacement_outside() subtracts Σ deficit_terms ·
  /// J0(wave_numbers · r).
  [[nodiscard]] double half_space_displacement(double r) const;
  [[nodiscard]] const Eigen::ArrayXd& wave_numbers() const { return wave_numbers_; }
  [[nodiscard]] const Eigen::ArrayXd& deficit_terms() const { return deficit_terms_; }
  [[nodiscard]] const Eigen::ArrayXd& base_terms() const { return base_terms_; }

 private:
  double contact_radius_;
  RadialDensity density_;
  NodeInterpolation interpolate_;
  // A term is kernel times transform of the pressure times weight.
  Eigen::ArrayXd wave_numbers_, deficit_terms_, base_terms_;
};

/// Returns the sum of terms · J0(wave_numbers · r).
[[nodiscard]] double bessel_sum(const Eigen::ArrayXd& terms, const Eigen::ArrayXd& wave_numbers, double r);

}  // namespace triskin::mechanics
