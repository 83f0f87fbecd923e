// SPDX-License-Identifier: GPL-3.0-or-later
#include "line_solution.hpp"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "triskin/mechanics/layer.hpp"
#include "units.hpp"

namespace triskin::mechanics {
namespace {

// The kernels fall as exp(−k).
constexpr double kLineCutoff = 26.0;

int term_count(double half_width) {
  return 14 + static_cast<int>(2.5 * half_width);
}

// With this B, the kernel ∫ compliance_ratio(k) / k · cos(kx) dk is −ln|x| + ½ ln(1 + x²) + ∫ B(k) cos(kx) dk.
double smooth_kernel(double k, double poisson) {
  return (std::exp(-k) - compliance_deficit(k, poisson)) / k;
}

Eigen::ArrayXd terms(const Quadrature& spectrum, double poisson, double (*kernel)(double, double)) {
  return spectrum.weights * spectrum.nodes.unaryExpr([&](double k) { return kernel(k, poisson); });
}

// The nodes are cos θ of Gauss-Chebyshev; T₂ₙ is cos 2nθ there.
Eigen::ArrayXd chebyshev_angles(int count) {
  return Eigen::ArrayXd::LinSpaced(count, 0.5, count - 0.5) * std::numbers::pi / count;
}

Eigen::MatrixXd even_polynomials(const Eigen::ArrayXd& angles, int count) {
  const Eigen::ArrayXd orders = Eigen::ArrayXd::LinSpaced(count, 0.0, 2.0 * (count - 1));
  return (angles.matrix() * orders.matrix().transpose()).array().cos().matrix();
}

// Returns ∫ −ln|x − aη| T₂ₙ(η) / √(1 − η²) dη on the contact, over T₂ₙ.
Eigen::ArrayXd logarithm_factors(int count, double half_width) {
  Eigen::ArrayXd factors(count);
  factors[0] = std::numbers::pi * (std::numbers::ln2 - std::log(half_width));
  for (int n = 1; n < count; ++n) factors[n] = std::numbers::pi / (2.0 * n);
  return factors;
}

Eigen::MatrixXd cosines(const Eigen::ArrayXd& a, const Eigen::ArrayXd& b) {
  return (a.matrix() * b.matrix().transpose()).array().cos().matrix();
}

// Evaluates the smooth part of the kernel between all pairs of points; sums of sines vanish for an even pressure.
Eigen::MatrixXd smooth_matrix(const Eigen::ArrayXd& points, const Quadrature& spectrum, const Eigen::ArrayXd& kernel) {
  const Eigen::MatrixXd c = cosines(spectrum.nodes, points);
  Eigen::MatrixXd s = c.transpose() * kernel.matrix().asDiagonal() * c;
  for (Eigen::Index i = 0; i < points.size(); ++i) {
    for (Eigen::Index j = 0; j < points.size(); ++j) {
      const double d = points[i] - points[j];
      s(i, j) += std::log1p(d * d) / 2.0;
    }
  }
  return s;
}

}  // namespace

LineSolution::LineSolution(double poisson, double half_width, double curvature)
    : half_width_(half_width), spectrum_(spectral_rule(kLineCutoff, 2.0 * half_width + kFieldReach)) {
  const int count = term_count(half_width);
  const Eigen::ArrayXd angles = chebyshev_angles(2 * count);
  const Eigen::MatrixXd polynomials = even_polynomials(angles, count);
  const double weight = half_width * std::numbers::pi / (2.0 * count);
  const Eigen::ArrayXd kernel = terms(spectrum_, poisson, smooth_kernel);
  points_ = half_width * angles.cos();
  const Eigen::MatrixXd smooth = weight * smooth_matrix(points_, spectrum_, kernel) * polynomials;
  const Eigen::ArrayXd factors = half_width * logarithm_factors(count, half_width);
  // Half of the nodes is enough because the contact is even. Unknowns are the coefficients and the indentation.
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(count + 1, count + 1);
  system.topLeftCorner(count, count) =
      (polynomials * factors.matrix().asDiagonal() + smooth).topRows(count) / std::numbers::pi;
  system.topRightCorner(count, 1).setConstant(-1.0);
  system.bottomLeftCorner(1, count).setOnes();
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count + 1);
  right.head(count) = -0.5 * curvature * points_.head(count).square().matrix();
  const Eigen::VectorXd solution = system.partialPivLu().solve(right);
  coefficients_ = solution.head(count);
  indentation_ = solution[count];
  weighted_pressure_ = weight * (polynomials * coefficients_).array();
  const Eigen::ArrayXd transform = (cosines(spectrum_.nodes, points_) * weighted_pressure_.matrix()).array();
  smooth_terms_ = kernel * transform;
  base_terms_ = terms(spectrum_, poisson, base_pressure_ratio) * transform / std::numbers::pi;
}

double LineSolution::force() const {
  return weighted_pressure_.sum();
}

double LineSolution::centre_pressure() const {
  double sum = 0.0;
  for (Eigen::Index n = 0; n < coefficients_.size(); ++n) sum += n % 2 == 0 ? coefficients_[n] : -coefficients_[n];
  return sum;
}

double LineSolution::smooth_part(double x) const {
  const double logarithm = (weighted_pressure_ * (x - points_).square().log1p()).sum() / 2.0;
  return logarithm + (smooth_terms_ * (spectrum_.nodes * x).cos()).sum();
}

double LineSolution::displacement_outside(double x) const {
  // On the far side X = x/a > 1 the integrals are −π ln((X + √(X² − 1)) / 2) and π/2n · (X − √(X² −
  // 1))²ⁿ.
  const double ratio = x / half_width_;
  const double larger = ratio + std::sqrt(ratio * ratio - 1.0);
  double sum = -coefficients_[0] * std::numbers::pi * std::log(half_width_ * larger / 2.0);
  double power = 1.0;
  for (Eigen::Index n = 1; n < coefficients_.size(); ++n) {
    power /= larger * larger;
    sum += coefficients_[n] * std::numbers::pi / (2.0 * static_cast<double>(n)) * power;
  }
  return (half_width_ * sum + smooth_part(x)) / std::numbers::pi;
}

double LineSolution::base_pressure(double x) const {
  return (base_terms_ * (spectrum_.nodes * x).cos()).sum();
}

}  // namespace triskin::mechanics
