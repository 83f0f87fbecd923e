// SPDX-License-Identifier: GPL-3.0-or-later
#include "nonnegative.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <limits>
#include <vector>

namespace triskin::mechanics {
namespace {

using Index = Eigen::Index;

Eigen::VectorXd solve_for(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, const std::vector<Index>& active) {
  Eigen::MatrixXd columns(a.rows(), static_cast<Index>(active.size()));
  for (std::size_t k = 0; k < active.size(); ++k) columns.col(static_cast<Index>(k)) = a.col(active[k]);
  return columns.colPivHouseholderQr().solve(b);
}

// Returns the largest fraction of the way from x to `target` on which no entry turns negative.
double feasible_share(const Eigen::VectorXd& x, const Eigen::VectorXd& target, const std::vector<Index>& active) {
  double share = 1.0;
  for (std::size_t k = 0; k < active.size(); ++k) {
    const double now = x[active[k]], then = target[static_cast<Index>(k)];
    if (then <= 0.0) share = std::min(share, now / (now - then));
  }
  return share;
}

// Moves x to the least-squares solution of its active entries; those that would turn negative become inactive.
void settle(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, std::vector<Index>& active, Eigen::VectorXd& x) {
  while (!active.empty()) {
    const Eigen::VectorXd target = solve_for(a, b, active);
    const double share = feasible_share(x, target, active);
    for (std::size_t k = 0; k < active.size(); ++k)
      x[active[k]] += share * (target[static_cast<Index>(k)] - x[active[k]]);
    if (share >= 1.0) return;
    std::erase_if(active, [&](Index i) {
      if (x[i] > 1e-14) return false;
      x[i] = 0.0;
      return true;
    });
  }
}

}  // namespace

Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, int max_active) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(a.cols());
  std::vector<Index> active;
  const double enough = 1e-9 * (a.transpose() * b).cwiseAbs().maxCoeff();
  // Rounding can add and remove one entry forever, so the number of turns is bounded.
  for (Index turn = 0; turn < 3 * a.cols() && static_cast<int>(active.size()) < max_active; ++turn) {
    Eigen::VectorXd gain = a.transpose() * (b - a * x);
    for (const Index i : active) gain[i] = -std::numeric_limits<double>::infinity();
    Index best = 0;
    if (a.cols() == 0 || gain.maxCoeff(&best) <= enough) break;
    active.push_back(best);
    settle(a, b, active, x);
  }
  return x;
}

}  // namespace triskin::mechanics
