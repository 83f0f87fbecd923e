// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <array>

namespace triskin::mechanics {

struct Quadrature {
  Eigen::ArrayXd nodes, weights;
};

/// Returns the Gauss-Legendre rule of `order` nodes in (from, to).
[[nodiscard]] Quadrature gauss_legendre(int order, double from, double to);

/// Divides the range into `count` intervals of equal length with `order` nodes each.
[[nodiscard]] Quadrature gauss_legendre_panels(int count, int order, double from, double to);

/// Returns a rule for integrands that behave like a square root at either end: the substitution x = (1 − cos πv) / 2
/// makes them smooth.
[[nodiscard]] Quadrature square_root_rule(int order, double from, double to);

/// Returns a rule over wave numbers 0 … `cutoff` that resolves cos(kx) for |x| up to `reach`.
[[nodiscard]] Quadrature spectral_rule(double cutoff, double reach);

/// Returns the weights of the values at 0, 1, 2, 3 in the cubic through them at `x`.
[[nodiscard]] std::array<double, 4> cubic_weights(double x);

/// Evaluates at `x` the polynomial through `values` at the nodes of gauss_legendre(values.size(), 0, length).
class NodeInterpolation {
 public:
  NodeInterpolation(const Quadrature& rule, double length);
  [[nodiscard]] double operator()(const Eigen::ArrayXd& values, double x) const;

 private:
  Eigen::ArrayXd nodes_, weights_;
};

}  // namespace triskin::mechanics
