// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_guess.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "nonnegative.hpp"
#include "triskin/mechanics/taxel.hpp"
#include "units.hpp"

namespace triskin::mechanics {
namespace {

constexpr double kGrid_mm = 2.0;
constexpr double kGridReach_mm = 5.0;
constexpr int kMaxActive = 40;
constexpr double kWeakShare = 0.02;
// Points that move every taxel less than this fraction of the best are dropped: a small signal there would need a huge
// force.
constexpr double kMinInfluenceShare = 0.3;
// The volume around a taxel is its displacement times its cell; this caps the cell of sparse taxels, which do not
// measure that far.
constexpr double kMaxCell_mm2 = 45.0;
constexpr double kCentroidReach_mm = 9.0;

// Returns points of a grid that lie near a pressed taxel.
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

// Returns the mean displacement of a taxel per newton on a punch as wide as the layer is thick: linear, and soft enough
// for a grid.
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

// Keeps only the points that move some taxel well; returns their columns.
Eigen::MatrixXd keep_influential(std::vector<Eigen::Vector2d>& points, const Eigen::MatrixXd& all) {
  const Eigen::VectorXd norms = all.colwise().norm();
  std::vector<Eigen::Index> kept;
  std::vector<Eigen::Vector2d> kept_points;
  for (Eigen::Index k = 0; k < all.cols(); ++k) {
    if (norms[k] < kMinInfluenceShare * norms.maxCoeff()) continue;
    kept.push_back(k);
    kept_points.push_back(points[static_cast<std::size_t>(k)]);
  }
  points = std::move(kept_points);
  return all(Eigen::all, kept);
}

// Joins forces at neighbouring points, also diagonally. The guess that explains most comes first.
std::vector<ForceGuess> joined(const std::vector<Eigen::Vector2d>& points, const Eigen::VectorXd& forces,
                               const Eigen::VectorXd& norms) {
  const Eigen::VectorXd signals = forces.cwiseProduct(norms);
  std::vector<std::size_t> loaded;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (signals[static_cast<Eigen::Index>(k)] > kWeakShare * signals.maxCoeff()) loaded.push_back(k);
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
  std::vector<double> explained(loaded.size(), 0.0);
  for (std::size_t a = 0; a < loaded.size(); ++a) {
    const auto at = static_cast<Eigen::Index>(loaded[a]);
    sums[find(a)].position_mm += forces[at] * points[loaded[a]];
    sums[find(a)].force_n += forces[at];
    explained[find(a)] += signals[at];
  }
  std::vector<std::size_t> order(loaded.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t k) { return sums[k].force_n == 0.0; });
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return explained[a] > explained[b]; });
  std::vector<ForceGuess> guesses;
  for (const std::size_t k : order) guesses.push_back({sums[k].position_mm / sums[k].force_n, sums[k].force_n});
  return guesses;
}

// Inverts x = u / (h − u), which holds for a disc that moves uniformly.
Eigen::VectorXd displacements(const TaxelModel& model, const Eigen::VectorXd& observed) {
  return (model.table().layer().thickness_mm * observed.array() / (1.0 + observed.array()).max(0.1)).matrix();
}

// Returns the area of a cell of a triangular lattice with the pitch of the nearest neighbour.
double cell_mm2(const std::vector<Eigen::Vector2d>& taxels, std::size_t taxel) {
  double nearest = std::sqrt(kMaxCell_mm2);
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    if (t != taxel) nearest = std::min(nearest, (taxels[t] - taxels[taxel]).norm());
  }
  return std::sqrt(0.75) * nearest * nearest;
}

}  // namespace

std::vector<ForceGuess> guess_contacts(const TaxelModel& model, const Eigen::VectorXd& observed, double signal_floor) {
  auto points = candidates(model, observed, signal_floor);
  if (points.empty()) return {};
  const Eigen::MatrixXd matrix = keep_influential(points, influence(model, points));
  const Eigen::VectorXd forces = nonnegative_least_squares(matrix, displacements(model, observed), kMaxActive);
  if (forces.maxCoeff() <= 0.0) return {};
  return joined(points, forces, matrix.colwise().norm());
}

std::vector<ForceGuess> guess_peak(const TaxelModel& model, const Eigen::VectorXd& observed) {
  Eigen::Index peak = 0;
  if (observed.size() == 0 || !(observed.maxCoeff(&peak) > 0.0)) return {};
  const auto& taxels = model.positions_mm();
  const Eigen::Vector2d centre = taxels[static_cast<std::size_t>(peak)];
  const Eigen::VectorXd u = displacements(model, observed);
  const Layer& layer = model.table().layer();
  const double stiffness =
      cell_mm2(taxels, static_cast<std::size_t>(peak)) * confined_modulus_kpa(layer) / layer.thickness_mm / kKpaMm2PerN;
  double sum = 0.0;
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    const double depth = u[static_cast<Eigen::Index>(t)];
    if ((taxels[t] - centre).norm() > kCentroidReach_mm || depth < 0.2 * u[peak]) continue;
    sum += depth;
    centroid += depth * taxels[t];
  }
  return {{centroid / sum, stiffness * sum}, {centre, stiffness * u[peak]}};
}

}  // namespace triskin::mechanics
