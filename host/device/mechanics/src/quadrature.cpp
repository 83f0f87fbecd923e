// SPDX-License-Identifier: GPL-3.0-or-later
#include "quadrature.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace triskin::mechanics {
namespace {

struct Legendre {
  double value, slope;
};

Legendre legendre(int order, double x) {
  double before = 1.0, now = x;
  for (int k = 2; k <= order; ++k) {
    const double next = ((2 * k - 1) * x * now - (k - 1) * before) / k;
    before = now;
    now = next;
  }
  return {now, order * (x * now - before) / (x * x - 1.0)};
}

}  // namespace

Quadrature gauss_legendre(int order, double from, double to) {
  Quadrature rule{Eigen::ArrayXd(order), Eigen::ArrayXd(order)};
  for (int i = 0; i < order; ++i) {
    double x = -std::cos(std::numbers::pi * (i + 0.75) / (order + 0.5));
    Legendre p = legendre(order, x);
    // Newton's iteration from this start converges quadratically; five steps reach the last bit.
    for (int step = 0; step < 5; ++step) {
      x -= p.value / p.slope;
      p = legendre(order, x);
    }
    rule.nodes[i] = from + (to - from) * (1.0 + x) / 2.0;
    rule.weights[i] = (to - from) / ((1.0 - x * x) * p.slope * p.slope);
  }
  return rule;
}

Quadrature gauss_legendre_panels(int count, int order, double from, double to) {
  const double length = (to - from) / count;
  const Quadrature one = gauss_legendre(order, 0.0, length);
  Quadrature rule{Eigen::ArrayXd(count * order), Eigen::ArrayXd(count * order)};
  for (int k = 0; k < count; ++k) {
    rule.nodes.segment(k * order, order) = one.nodes + (from + k * length);
    rule.weights.segment(k * order, order) = one.weights;
  }
  return rule;
}

Quadrature square_root_rule(int order, double from, double to) {
  Quadrature rule = gauss_legendre(order, 0.0, 1.0);
  rule.weights *= (to - from) * std::numbers::pi / 2.0 * (std::numbers::pi * rule.nodes).sin();
  rule.nodes = from + (to - from) * (1.0 - (std::numbers::pi * rule.nodes).cos()) / 2.0;
  return rule;
}

Quadrature spectral_rule(double cutoff, double reach) {
  // Sixteen nodes of Gauss resolve two periods to twelve digits; the kernel itself needs panels of unit length.
  const double periods = cutoff * reach / (2.0 * std::numbers::pi);
  const int panels = static_cast<int>(std::ceil(std::max(cutoff / 1.5, periods / 2.0)));
  return gauss_legendre_panels(panels, 16, 0.0, cutoff);
}

std::array<double, 4> cubic_weights(double x) {
  return {-(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0, x * (x - 2.0) * (x - 3.0) / 2.0, -x * (x - 1.0) * (x - 3.0) / 2.0,
          x * (x - 1.0) * (x - 2.0) / 6.0};
}

NodeInterpolation::NodeInterpolation(const Quadrature& rule, double length)
    : nodes_(rule.nodes), weights_(rule.nodes.size()) {
  // The barycentric weights of Gauss-Legendre nodes follow Wang and Xiang, Math. Comp. 81 (2012) 861.
  const Eigen::ArrayXd x = 2.0 * nodes_ / length - 1.0;
  weights_ = ((1.0 - x * x) * rule.weights).sqrt();
  for (Eigen::Index i = 1; i < weights_.size(); i += 2) weights_[i] = -weights_[i];
}

double NodeInterpolation::operator()(const Eigen::ArrayXd& values, double x) const {
  double top = 0.0, bottom = 0.0;
  for (Eigen::Index i = 0; i < nodes_.size(); ++i) {
    if (x == nodes_[i]) return values[i];
    const double term = weights_[i] / (x - nodes_[i]);
    top += term * values[i];
    bottom += term;
  }
  return top / bottom;
}

}  // namespace triskin::mechanics
