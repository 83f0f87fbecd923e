// SPDX-License-Identifier: GPL-3.0-or-later
// Computes the exact contact by a method that shares nothing with the code: pressures as sums of (1 − r²/a²)^(n −
// 1/2), whose transforms are Bessel functions (Sonine), collocated under the indenter. The code solves Abel-transformed
// dual integral equations instead. Half-space displacements of these pressures are known in closed form (Weber and
// Schafheitlin: Abramowitz and Stegun 11.4.33), so only the layer's share is integrated.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <functional>
#include <numbers>

#include "device/mechanics/src/bonded_layer.hpp"

namespace triskin::mechanics {
namespace {

using std::numbers::pi;

struct Solved {
  double indentation_mm, force, peak_kpa;
};

// Returns 1 − M(k) of the layer (Jaffar 1989, equation of the kernel), k in 1/h.
double deficit(double k, double nu) {
  const double kappa = 3.0 - 4.0 * nu;
  const double top = 2.0 * kappa * std::sinh(2.0 * k) - 4.0 * k;
  return 1.0 - top / (2.0 * kappa * std::cosh(2.0 * k) + 1.0 + kappa * kappa + 4.0 * k * k);
}

double simpson(double from, double to, int steps, const std::function<double(double)>& f) {
  const double step = (to - from) / (2 * steps);
  double sum = f(from) + f(to);
  for (int k = 1; k < 2 * steps; ++k) sum += (k % 2 == 1 ? 4.0 : 2.0) * f(from + k * step);
  return sum * step / 3.0;
}

// ₂F₁(1/2, −n; 1; x) is a polynomial.
double hypergeometric(int n, double x) {
  double term = 1.0, sum = 1.0;
  for (int k = 0; k < n; ++k) {
    term *= (0.5 + k) * (k - n) / ((k + 1.0) * (k + 1.0)) * x;
    sum += term;
  }
  return sum;
}

// Returns ∫ p r J0(kr) dr of the n-th pressure.
double transform(int n, double a, double k) {
  const double x = std::max(k * a, 1e-6);
  return a * a * std::pow(2.0, n - 0.5) * std::tgamma(n + 0.5) * std::sqrt(2.0 / pi) *
         std::sph_bessel(static_cast<unsigned>(n), x) / std::pow(x, n);
}

constexpr int kTerms = 12, kPoints = 26;

// Returns displacements at ρ = r/a, one row per point, one column per pressure. Lengths are in thicknesses, with unit
// compliance.
Eigen::MatrixXd round_displacements(const Eigen::VectorXd& rho, double a, double nu) {
  Eigen::MatrixXd u(rho.size(), kTerms);
  constexpr int kSteps = 400;
  constexpr double kCutoff = 18.0;
  for (int n = 1; n <= kTerms; ++n) {
    std::vector<double> spectrum;
    for (int s = 0; s <= 2 * kSteps; ++s) {
      const double k = kCutoff * s / (2 * kSteps);
      spectrum.push_back(deficit(k, nu) * transform(n, a, k));
    }
    const double half_space = a * std::sqrt(pi) * std::tgamma(n + 0.5) / (2.0 * std::tgamma(n + 1.0));
    for (Eigen::Index i = 0; i < rho.size(); ++i) {
      const auto at = [&](double k) {
        const auto s = static_cast<std::size_t>(std::lround(k / kCutoff * 2 * kSteps));
        return spectrum[s] * std::cyl_bessel_j(0.0, k * a * rho[i]);
      };
      u(i, n - 1) = half_space * hypergeometric(n, rho[i] * rho[i]) - simpson(0.0, kCutoff, kSteps, at);
    }
  }
  return u;
}

Eigen::VectorXd collocation_points() {
  return (Eigen::ArrayXd::LinSpaced(kPoints, 0.5, kPoints - 0.5) * pi / (2.0 * kPoints)).sin().matrix();
}

// Returns the pressures and the indentation at which the displacement is δ − gap at all points.
Eigen::VectorXd collocated(const Eigen::MatrixXd& u, const Eigen::VectorXd& gaps) {
  Eigen::MatrixXd system(u.rows(), u.cols() + 1);
  system << u, Eigen::VectorXd::Constant(u.rows(), -1.0);
  return system.colPivHouseholderQr().solve(-gaps);
}

// Solves the contact of radius `a` (thicknesses) of a sphere or paraboloid of radius `radius` (thicknesses).
Solved solve_round(const Layer& layer, Shape shape, double radius, double a) {
  const Eigen::VectorXd rho = collocation_points();
  const Eigen::ArrayXd r = a * rho.array();
  const Eigen::ArrayXd gaps = shape == Shape::kSphere ? Eigen::ArrayXd(radius - (radius * radius - r.square()).sqrt())
                                                      : Eigen::ArrayXd(r.square() / (2.0 * radius));
  const Eigen::VectorXd x = collocated(round_displacements(rho, a, layer.poisson), gaps.matrix());
  double force = 0.0, peak = 0.0;
  for (int n = 1; n <= kTerms; ++n) {
    force += x[n - 1] * 2.0 * pi * a * a / (2.0 * n + 1.0);
    peak += x[n - 1];
  }
  const double h = layer.thickness_mm, compliance = 2.0 * (1.0 - layer.poisson * layer.poisson) / layer.modulus_kpa;
  return {x[kTerms] * h, force * h * h / compliance / 1000.0, peak / compliance};
}

// For a line, ∫ p cos(kx) dx of the n-th pressure is √π Γ(n + 1/2) (2/s)ⁿ J_n(s) · a with s = ka.
Solved solve_line(const Layer& layer, double radius, double a) {
  const Eigen::VectorXd xi = collocation_points();
  constexpr int kLineTerms = 10, kSteps = 6000;
  const double cutoff = 400.0 / a;
  Eigen::MatrixXd u(kPoints, kLineTerms);
  for (int n = 1; n <= kLineTerms; ++n) {
    std::vector<double> spectrum;
    for (int s = 0; s <= 2 * kSteps; ++s) {
      const double k = std::max(1e-7, cutoff * s / (2 * kSteps)), x = k * a;
      const double shape = std::sqrt(pi) * std::tgamma(n + 0.5) * std::pow(2.0 / x, n) * std::cyl_bessel_j(n, x);
      spectrum.push_back(a * shape * (k > 18.0 ? 1.0 : 1.0 - deficit(k, layer.poisson)) / k / pi);
    }
    for (int i = 0; i < kPoints; ++i) {
      u(i, n - 1) = simpson(0.0, cutoff, kSteps, [&](double k) {
        return spectrum[static_cast<std::size_t>(std::lround(k / cutoff * 2 * kSteps))] * std::cos(k * a * xi[i]);
      });
    }
  }
  const Eigen::VectorXd x = collocated(u, (a * xi.array()).square().matrix() / (2.0 * radius));
  double force = 0.0, peak = 0.0;
  for (int n = 1; n <= kLineTerms; ++n) {
    force += x[n - 1] * a * std::sqrt(pi) * std::tgamma(n + 0.5) / std::tgamma(n + 1.0);
    peak += x[n - 1];
  }
  const double h = layer.thickness_mm, compliance = 2.0 * (1.0 - layer.poisson * layer.poisson) / layer.modulus_kpa;
  return {x[kLineTerms] * h, force * h / compliance / 1000.0, peak / compliance};
}

void expect_equal(const Contact& contact, const Solved& solved, double a_mm, double tolerance) {
  EXPECT_NEAR(contact.indentation_mm / solved.indentation_mm, 1.0, tolerance);
  EXPECT_NEAR(contact.contact_radius_mm / a_mm, 1.0, tolerance);
  EXPECT_NEAR(contact.peak_pressure_kpa / solved.peak_kpa, 1.0, tolerance);
}

class Independent : public testing::TestWithParam<double> {};

// The cases are a small contact on a thick layer, a wide one on a thin layer, and nearly incompressible layers, where
// the force at a given indentation changes a hundredfold.
TEST_P(Independent, RoundContacts) {
  const Layer layer{2.0, GetParam(), 100.0};
  for (const double a : {0.05, 0.3, 1.0, 2.5, 6.0}) {
    for (const Shape shape : {Shape::kSphere, Shape::kParaboloid}) {
      // The indentation is about a²/R, a fifth of the layer.
      const double radius = std::max(2.0 * a, 5.0 * a * a);
      const Solved solved = solve_round(layer, shape, radius, a);
      SCOPED_TRACE(testing::Message() << "a/h " << a << ", shape " << static_cast<int>(shape));
      expect_equal(press_bonded(layer, {shape, radius * layer.thickness_mm}, solved.force), solved,
                   a * layer.thickness_mm, 2e-4);
    }
  }
}

TEST_P(Independent, Lines) {
  const Layer layer{2.0, GetParam(), 100.0};
  for (const double a : {0.1, 1.0, 4.0}) {
    const double radius = std::max(2.0 * a, 5.0 * a * a);
    const Solved solved = solve_line(layer, radius, a);
    SCOPED_TRACE(testing::Message() << "a/h " << a);
    expect_equal(press_bonded(layer, {Shape::kLine, radius * layer.thickness_mm}, solved.force), solved,
                 a * layer.thickness_mm, 2e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Poisson, Independent, testing::Values(0.0, 0.1, 0.3, 0.45, 0.49));

}  // namespace
}  // namespace triskin::mechanics
