// SPDX-License-Identifier: GPL-3.0-or-later
#include "footprint_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace triskin::mechanics {
namespace {

constexpr int kPlaces = 9, kRadiusSteps = 7, kMaxLevels = 8;
// A grid resolves a distribution if its deviation is at least this share of the grid's step.
constexpr double kResolvedSteps = 0.8;
constexpr double kWindowDeviations = 3.0;
// Between points of a coarse grid the values of taxels change by this share of the largest for each mm. We treat that
// as noise until the grid is fine; otherwise one point would win by chance.
constexpr double kChangePerMm = 0.12;

using Point = Eigen::Vector3d;  // The coordinates are x, y and ln a.

struct GridPoint {
  Point at;
  double force = 0.0, force_variance = 0.0, log_weight = 0.0;
};

struct GridMoments {
  Point mean = Point::Zero(), deviation = Point::Zero();
  double force = 0.0, force_sd = 0.0;
};

class FootprintGrid {
 public:
  FootprintGrid(const Footprint& footprint, const PlaneTaxels& taxels, const FootprintPrior& prior)
      : footprint_(footprint), taxels_(taxels), prior_(prior) {}

  // Returns the moments over the box centre ± half, or nothing if no point has a force.
  [[nodiscard]] std::optional<GridMoments> moments(const Point& centre, const Point& half, double sd_kpa) const {
    std::vector<GridPoint> points;
    for (int i = 0; i < kPlaces; ++i) {
      for (int j = 0; j < kPlaces; ++j) {
        for (int k = 0; k < kRadiusSteps; ++k) {
          const Point unit(2.0 * i / (kPlaces - 1) - 1.0, 2.0 * j / (kPlaces - 1) - 1.0,
                           2.0 * k / (kRadiusSteps - 1) - 1.0);
          if (const auto point = evaluated(centre + unit.cwiseProduct(half), sd_kpa * sd_kpa)) points.push_back(*point);
        }
      }
    }
    if (points.empty()) return std::nullopt;
    return averaged(points);
  }

 private:
  // The model is linear in the force, so the best force at a place and radius is a ratio of sums.
  [[nodiscard]] std::optional<GridPoint> evaluated(const Point& at, double variance) const {
    const double radius = std::exp(at.z());
    double square = 0.0, product = 0.0;
    for (std::size_t t = 0; t < taxels_.places_mm.size(); ++t) {
      const double per_newton = footprint_.kpa_per_newton(radius, (taxels_.places_mm[t] - at.head<2>()).norm());
      square += per_newton * per_newton;
      product += per_newton * taxels_.kpa[static_cast<Eigen::Index>(t)];
    }
    if (!(product > 0.0) || !(square > 0.0)) return std::nullopt;
    const double force = product / square;
    const double radius_off = (at.z() - prior_.log_radius) / prior_.log_radius_sd;
    const double force_off = (std::log(force) - prior_.log_force) / prior_.log_force_sd;
    // The force is integrated out; its prior is almost constant over the width that the values allow.
    const double log_weight = 0.5 * force * product / variance - 0.5 * std::log(square) - std::log(force) -
                              0.5 * (radius_off * radius_off + force_off * force_off);
    return GridPoint{at, force, variance / square, log_weight};
  }
  [[nodiscard]] static GridMoments averaged(const std::vector<GridPoint>& points) {
    double highest = -std::numeric_limits<double>::infinity(), sum = 0.0, square = 0.0;
    for (const GridPoint& p : points) highest = std::max(highest, p.log_weight);
    GridMoments m;
    Point squares = Point::Zero();
    for (const GridPoint& p : points) {
      const double weight = std::exp(p.log_weight - highest);
      sum += weight;
      m.mean += weight * p.at;
      squares += weight * p.at.cwiseAbs2();
      m.force += weight * p.force;
      square += weight * (p.force * p.force + p.force_variance);
    }
    m.mean /= sum;
    m.force /= sum;
    m.deviation = (squares / sum - m.mean.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
    m.force_sd = std::sqrt(std::max(0.0, square / sum - m.force * m.force));
    return m;
  }

  const Footprint& footprint_;
  const PlaneTaxels& taxels_;
  const FootprintPrior& prior_;
};

}  // namespace

std::optional<FootprintFit> fit_footprint(const Footprint& footprint, const PlaneTaxels& taxels,
                                          const FootprintPrior& prior, const Eigen::Vector2d& about_mm,
                                          double half_width_mm) {
  const FootprintGrid grid(footprint, taxels, prior);
  const Point steps(2.0 / (kPlaces - 1), 2.0 / (kPlaces - 1), 2.0 / (kRadiusSteps - 1));
  Point centre(about_mm.x(), about_mm.y(), prior.log_radius);
  Point half(half_width_mm, half_width_mm, kWindowDeviations * prior.log_radius_sd);
  const double largest_kpa = taxels.kpa.maxCoeff();
  std::optional<GridMoments> moments;
  for (int level = 0; level < kMaxLevels; ++level) {
    const Point step = half.cwiseProduct(steps);
    const double coarse_sd = kChangePerMm * largest_kpa * step.head<2>().maxCoeff();
    const auto found = grid.moments(centre, half, std::hypot(taxels.sd_kpa, coarse_sd));
    if (!found) break;
    moments = found;
    if (coarse_sd < taxels.sd_kpa && (found->deviation.array() >= kResolvedSteps * step.array()).all()) break;
    centre = found->mean;
    half = (kWindowDeviations * found->deviation).cwiseMax(step).cwiseMin(half);
  }
  if (!moments) return std::nullopt;
  return FootprintFit{moments->mean.head<2>(), moments->deviation.head<2>(), moments->force, moments->force_sd,
                      std::exp(moments->mean.z())};
}

Eigen::VectorXd predicted_kpa(const Footprint& footprint, std::span<const Eigen::Vector2d> places_mm,
                              const FootprintFit& fit) {
  Eigen::VectorXd kpa(static_cast<Eigen::Index>(places_mm.size()));
  for (std::size_t t = 0; t < places_mm.size(); ++t)
    kpa[static_cast<Eigen::Index>(t)] =
        fit.force_n * footprint.kpa_per_newton(fit.radius_mm, (places_mm[t] - fit.position_mm).norm());
  return kpa;
}

}  // namespace triskin::mechanics
