// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_patch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "disc_points.hpp"
#include "layer_convolution.hpp"
#include "quadrature.hpp"
#include "root.hpp"
#include "triskin/base/error.hpp"
#include "triskin/mechanics/contact.hpp"
#include "units.hpp"

namespace triskin::mechanics {
namespace {

constexpr int kMaxIterations = 1000;
constexpr double kTolerance = 1e-7;
constexpr double kBorderThicknesses = 4.0;
constexpr int kMinPoints = 8, kMaxPoints = 2048;
// A patch that grows for a body stops here, because it would follow a plate forever.
constexpr int kMaxBodyPoints = 400;

void check_grid(const PatchGrid& grid, const Eigen::ArrayXXd& gap) {
  const auto is_good = [](int points) { return points >= kMinPoints && points <= kMaxPoints && points % 2 == 0; };
  if (!is_good(grid.points_x) || !is_good(grid.points_y))
    throw InputError(fmt::format("patch: {} × {} points; give even numbers of {} … {}", grid.points_x, grid.points_y,
                                 kMinPoints, kMaxPoints));
  if (!(grid.spacing_mm > 0.0) || !std::isfinite(grid.spacing_mm))
    throw InputError(fmt::format("patch: the spacing is {} mm; give a positive number", grid.spacing_mm));
  if (gap.rows() != grid.points_x || gap.cols() != grid.points_y)
    throw InputError("patch: the gap has another number of points than the patch");
  if (!gap.isFinite().any()) throw InputError("patch: no point of it lies under the body; move the body");
}

// Runs the conjugate gradients of Polonsky and Keer. The unknown is the pressure; `residual` is gap + displacement less
// its mean over the points in contact.
class PressureSearch {
 public:
  PressureSearch(LayerConvolution& convolution, const Eigen::ArrayXXd& gap, double pressure_sum,
                 double stiffness_kpa_per_mm)
      : convolution_(convolution), gap_(gap), sum_(pressure_sum) {
    // Points beside the body never touch; a large finite gap expresses that without infinities in the sums.
    const double far = 10.0 * (1.0 + gap.isFinite().select(gap, 0.0).maxCoeff());
    gap_ = gap.isFinite().select(gap, far);
    pressure_ = column_pressure(stiffness_kpa_per_mm);
    direction_ = Eigen::ArrayXXd::Zero(gap.rows(), gap.cols());
  }
  // Makes one step and returns how much of the force moved.
  double step();
  [[nodiscard]] const Eigen::ArrayXXd& pressure() const { return pressure_; }

 private:
  // Returns the pressure of independent columns with the wanted sum, as the start.
  [[nodiscard]] Eigen::ArrayXXd column_pressure(double stiffness_kpa_per_mm) const {
    const auto pressure = [&](double depth) -> Eigen::ArrayXXd {
      return stiffness_kpa_per_mm * (depth - gap_).max(0.0);
    };
    const double enough = sum_ / stiffness_kpa_per_mm + 1.0;
    return pressure(root_between(0.0, enough, [&](double depth) { return pressure(depth).sum() - sum_; }, 1e-9));
  }
  [[nodiscard]] double contact_mean(const Eigen::ArrayXXd& values) const {
    return (values * in_contact_).sum() / in_contact_.sum();
  }

  LayerConvolution& convolution_;
  Eigen::ArrayXXd gap_, pressure_, direction_, in_contact_;
  double sum_, last_norm_ = 1.0;
  bool restart_ = true;
};

double PressureSearch::step() {
  in_contact_ = (pressure_ > 0.0).cast<double>();
  Eigen::ArrayXXd residual = convolution_.displacement(pressure_) + gap_;
  residual -= contact_mean(residual);
  const double norm = (residual.square() * in_contact_).sum();
  if (norm == 0.0) return 0.0;
  direction_ = in_contact_ * (residual + (restart_ ? 0.0 : norm / last_norm_) * direction_);
  last_norm_ = norm;
  Eigen::ArrayXXd change = convolution_.displacement(direction_);
  change -= contact_mean(change);
  const double length = (residual * direction_).sum() / (change * direction_ * in_contact_).sum();
  const Eigen::ArrayXXd before = pressure_;
  pressure_ = (pressure_ - length * direction_).max(0.0);
  const Eigen::ArrayXXd overlaps = (pressure_ == 0.0 && residual < 0.0).cast<double>();
  restart_ = overlaps.sum() > 0.0;
  pressure_ -= length * overlaps * residual;
  pressure_ *= sum_ / pressure_.sum();
  return (pressure_ - before).abs().sum() / sum_;
}

// Returns true if all of the contact lies so far inside that the copies of the patch around it do not matter.
bool is_clear_of_border(const Layer& layer, const PatchContact& contact) {
  const PatchGrid& grid = contact.grid;
  const int margin = static_cast<int>(std::ceil(kBorderThicknesses * layer.thickness_mm / grid.spacing_mm));
  const int inner_x = grid.points_x - 2 * margin, inner_y = grid.points_y - 2 * margin;
  if (inner_x <= 0 || inner_y <= 0) return false;
  const double inside = contact.pressure_kpa.block(margin, margin, inner_x, inner_y).sum();
  return inside >= contact.pressure_kpa.sum() * (1.0 - 1e-9);
}

int even_points(double length_mm, double spacing_mm) {
  if (!(spacing_mm > 0.0))
    throw InputError(fmt::format("patch: the spacing is {} mm; give a positive number", spacing_mm));
  // Lengths of 2ᵃ·3ᵇ·5ᶜ are fast.
  int points = static_cast<int>(std::ceil(length_mm / spacing_mm));
  const auto is_smooth = [](int n) {
    for (const int p : {2, 3, 5})
      while (n % p == 0) n /= p;
    return n == 1;
  };
  while (points % 2 != 0 || !is_smooth(points)) ++points;
  return std::max(points, kMinPoints);
}

}  // namespace

Eigen::ArrayXXd gap_over(const Body& body, const PatchGrid& grid) {
  Eigen::ArrayXXd gap(grid.points_x, grid.points_y);
  for (int j = 0; j < grid.points_y; ++j) {
    for (int i = 0; i < grid.points_x; ++i) gap(i, j) = body.lower_surface_mm(grid.x(i), grid.y(j));
  }
  return gap - gap.minCoeff();
}

namespace {

PatchContact solve_patch(const Layer& layer, const PatchGrid& grid, const Eigen::ArrayXXd& gap_mm, double force_n) {
  LayerConvolution convolution(layer, grid);
  const double cell = grid.spacing_mm * grid.spacing_mm;
  PressureSearch search(convolution, gap_mm, kKpaMm2PerN * force_n / cell,
                        confined_modulus_kpa(layer) / layer.thickness_mm);
  PatchContact contact;
  contact.grid = grid;
  contact.force_n = force_n;
  while (search.step() > kTolerance) {
    if (++contact.iterations >= kMaxIterations)
      throw InputError("patch: the contact does not settle; take a finer patch or a rounder body");
  }
  contact.pressure_kpa = search.pressure();
  contact.displacement_mm = convolution.displacement(contact.pressure_kpa);
  contact.base_pressure_kpa = convolution.base_pressure(contact.pressure_kpa);
  const Eigen::ArrayXXd pressed = (contact.pressure_kpa > 0.0).cast<double>();
  const Eigen::ArrayXXd finite_gap = gap_mm.isFinite().select(gap_mm, 0.0);
  contact.indentation_mm = ((contact.displacement_mm + finite_gap) * pressed).sum() / pressed.sum();
  contact.contact_area_mm2 = pressed.sum() * cell;
  contact.peak_pressure_kpa = contact.pressure_kpa.maxCoeff();
  return contact;
}

}  // namespace

PatchContact press_on_patch(const Layer& layer, const PatchGrid& grid, const Eigen::ArrayXXd& gap_mm, double force_n) {
  check(layer);
  check_force(force_n);
  check_grid(grid, gap_mm);
  PatchContact contact = solve_patch(layer, grid, gap_mm, force_n);
  if (!is_clear_of_border(layer, contact)) {
    throw InputError(fmt::format("patch: the contact comes within {} mm of its border; take a larger patch",
                                 kBorderThicknesses * layer.thickness_mm));
  }
  check_indentation(layer, contact.displacement_mm.maxCoeff());
  return contact;
}

PatchContact press_body(const Layer& layer, const Body& body, double force_n, double spacing_mm) {
  check(layer);
  check_force(force_n);
  double side_mm = 12.0 * layer.thickness_mm;
  while (true) {
    const int points = even_points(side_mm, spacing_mm);
    const PatchGrid grid{points, points, spacing_mm};
    const Eigen::ArrayXXd gap = gap_over(body, grid);
    const bool is_last = points > kMaxBodyPoints;
    if (is_last) return press_on_patch(layer, grid, gap, force_n);
    if (gap.isFinite().any()) {
      check_grid(grid, gap);
      const PatchContact contact = solve_patch(layer, grid, gap, force_n);
      if (is_clear_of_border(layer, contact)) {
        check_indentation(layer, contact.displacement_mm.maxCoeff());
        return contact;
      }
    }
    side_mm *= 1.6;
  }
}

double displacement_mm(const PatchContact& contact, const Eigen::Vector2d& position_mm) {
  const PatchGrid& grid = contact.grid;
  const double i = (position_mm.x() - grid.x(0)) / grid.spacing_mm, j = (position_mm.y() - grid.y(0)) / grid.spacing_mm;
  if (!(i >= 1.0 && j >= 1.0 && i < grid.points_x - 2 && j < grid.points_y - 2)) return 0.0;
  const auto row = static_cast<Eigen::Index>(i) - 1, column = static_cast<Eigen::Index>(j) - 1;
  const auto along_x = cubic_weights(i - static_cast<double>(row));
  const auto along_y = cubic_weights(j - static_cast<double>(column));
  double sum = 0.0;
  for (std::size_t n = 0; n < 4; ++n) {
    for (std::size_t m = 0; m < 4; ++m) {
      sum += along_x[m] * along_y[n] *
             contact.displacement_mm(row + static_cast<Eigen::Index>(m), column + static_cast<Eigen::Index>(n));
    }
  }
  return sum;
}

double taxel_dc_over_c(const Layer& layer, const PatchContact& contact, const Eigen::Vector2d& position_mm,
                       double disc_diameter_mm) {
  double sum = 0.0;
  for (const DiscPoint& p : disc_points()) {
    const double u = displacement_mm(contact, position_mm + disc_diameter_mm / 2.0 * p.position);
    sum += p.weight * u / (layer.thickness_mm - u);
  }
  return sum;
}

}  // namespace triskin::mechanics
