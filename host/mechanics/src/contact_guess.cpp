// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_guess.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "nonnegative.hpp"
#include "triskin/mechanics/taxel.hpp"

namespace triskin::mechanics {
namespace {

constexpr double kGrid_mm = 2.0;
constexpr double kGridReach_mm = 5.0;
constexpr int kMaxActive = 40;
constexpr double kWeakShare = 0.02;

// Points of a grid that lie near a pressed taxel.
std::vector<Eigen::Vector2d> candidates(const TaxelModel& model, const Eigen::VectorXd& observed, double floor) {
  std::set<std::pair<int, int>> cells;
  const int reach = static_cast<int>(kGridReach_mm / kGrid_mm) + 1;
  for (Eigen::Index t = 0; t < observed.size(); ++t) {
    if (observed[t] <= floor) continue;
    const Eigen::Vector2d at = model.positions_mm()[static_cast<std::size_t>(t)] / kGrid_mm;
    const int x = static_cast<int>(std::lround(at.x())), y = static_cast<int>(std::lround(at.y()));
    for (int i = -reach; i <= reach; ++i) {
      for (int j = -reach; j <= reach; ++j) {
        const Eigen::Vector2d offset = kGrid_mm * (Eigen::Vector2d(x + i, y + j) - at);
        if (offset.norm() <= kGridReach_mm) cells.insert({x + i, y + j});
      }
    }
  }
  std::vector<Eigen::Vector2d> points;
  for (const auto& [x, y] : cells) points.emplace_back(kGrid_mm * x, kGrid_mm * y);
  return points;
}

// Mean displacement of a taxel per newton on a punch as wide as the layer is thick: linear, and soft enough for a grid.
Eigen::MatrixXd influence(const TaxelModel& model, const std::vector<Eigen::Vector2d>& points) {
  const Layer& layer = model.table().layer();
  const double unit = 1e-3;
  const Contact punch = model.table().press({Shape::kFlatPunch, layer.thickness_mm}, unit);
  const double reach = 6.0 * layer.thickness_mm, step = 0.25;
  std::vector<double> profile;
  for (double r = 0.0; r < reach; r += step)
    profile.push_back(taxel_displacement_mm(punch, r, 2.0 * model.disc_radius_mm()) / unit);
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(model.positions_mm().size()),
                         static_cast<Eigen::Index>(points.size()));
  for (Eigen::Index t = 0; t < matrix.rows(); ++t) {
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) {
      const double r = (model.positions_mm()[static_cast<std::size_t>(t)] - points[static_cast<std::size_t>(k)]).norm();
      const auto i = static_cast<std::size_t>(r / step);
      const double share = r / step - static_cast<double>(i);
      matrix(t, k) = i + 1 < profile.size() ? profile[i] + share * (profile[i + 1] - profile[i]) : 0.0;
    }
  }
  return matrix;
}

// Joins forces whose points are neighbours, also diagonally.
std::vector<ForceGuess> joined(const std::vector<Eigen::Vector2d>& points, const Eigen::VectorXd& forces) {
  std::vector<std::size_t> loaded;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (forces[static_cast<Eigen::Index>(k)] > kWeakShare * forces.maxCoeff()) loaded.push_back(k);
  }
  std::vector<std::size_t> root(loaded.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t k) {
    while (root[k] != k) k = root[k];
    return k;
  };
  for (std::size_t a = 0; a < loaded.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      if ((points[loaded[a]] - points[loaded[b]]).norm() < 2.1 * kGrid_mm) root[find(a)] = find(b);
    }
  }
  std::vector<ForceGuess> sums(loaded.size(), {Eigen::Vector2d::Zero(), 0.0});
  for (std::size_t a = 0; a < loaded.size(); ++a) {
    const double force = forces[static_cast<Eigen::Index>(loaded[a])];
    sums[find(a)].position_mm += force * points[loaded[a]];
    sums[find(a)].force_n += force;
  }
  std::erase_if(sums, [](const ForceGuess& g) { return g.force_n == 0.0; });
  for (ForceGuess& g : sums) g.position_mm /= g.force_n;
  return sums;
}

}  // namespace

std::vector<ForceGuess> guess_contacts(const TaxelModel& model, const Eigen::VectorXd& observed, double signal_floor) {
  const auto points = candidates(model, observed, signal_floor);
  if (points.empty()) return {};
  const double h = model.table().layer().thickness_mm;
  // A disc that moves as one says x = u / (h − u).
  const Eigen::VectorXd displacements = (h * observed.array() / (1.0 + observed.array()).max(0.1)).matrix();
  const Eigen::VectorXd forces = nonnegative_least_squares(influence(model, points), displacements, kMaxActive);
  if (forces.maxCoeff() <= 0.0) return {};
  auto guesses = joined(points, forces);
  std::sort(guesses.begin(), guesses.end(),
            [](const ForceGuess& a, const ForceGuess& b) { return a.force_n > b.force_n; });
  return guesses;
}

}  // namespace triskin::mechanics
