// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_convolution.hpp"

#include <cmath>
#include <numbers>

namespace triskin::mechanics {
namespace {

// Returns the wave number of the k-th of `points` coefficients; the upper half stands for negative ones.
double wave_number(int k, int points, double spacing_mm) {
  const int folded = 2 * k <= points ? k : k - points;
  return 2.0 * std::numbers::pi * folded / (points * spacing_mm);
}

double compliance(const Layer& layer, double wave_number_per_mm) {
  if (wave_number_per_mm == 0.0) return layer.thickness_mm / confined_modulus_kpa(layer);
  return half_space_compliance_per_kpa(layer) *
         compliance_ratio(wave_number_per_mm * layer.thickness_mm, layer.poisson) / wave_number_per_mm;
}

}  // namespace

LayerConvolution::LayerConvolution(const Layer& layer, const PatchGrid& grid)
    : points_x_(grid.points_x), points_y_(grid.points_y) {
  real_transform_.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  compliance_.resize(points_x_ / 2 + 1, points_y_);
  base_.resize(points_x_ / 2 + 1, points_y_);
  for (int j = 0; j < points_y_; ++j) {
    for (int i = 0; i <= points_x_ / 2; ++i) {
      const double k =
          std::hypot(wave_number(i, points_x_, grid.spacing_mm), wave_number(j, points_y_, grid.spacing_mm));
      compliance_(i, j) = compliance(layer, k);
      base_(i, j) = base_pressure_ratio(k * layer.thickness_mm, layer.poisson);
    }
  }
}

Eigen::ArrayXXd LayerConvolution::displacement(const Eigen::ArrayXXd& pressure_kpa) {
  return backward(forward(pressure_kpa) * compliance_);
}

Eigen::ArrayXXd LayerConvolution::base_pressure(const Eigen::ArrayXXd& pressure_kpa) {
  return backward(forward(pressure_kpa) * base_);
}

LayerConvolution::Spectrum LayerConvolution::forward(const Eigen::ArrayXXd& values) {
  Spectrum spectrum(points_x_ / 2 + 1, points_y_);
  for (int j = 0; j < points_y_; ++j)
    real_transform_.fwd(spectrum.col(j).data(), values.col(j).data(), static_cast<Eigen::Index>(points_x_));
  Eigen::VectorXcd row(points_y_), result(points_y_);
  for (int i = 0; i <= points_x_ / 2; ++i) {
    row = spectrum.row(i);
    transform_.fwd(result.data(), row.data(), static_cast<Eigen::Index>(points_y_));
    spectrum.row(i) = result.array().transpose();
  }
  return spectrum;
}

Eigen::ArrayXXd LayerConvolution::backward(Spectrum spectrum) {
  Eigen::VectorXcd row(points_y_), result(points_y_);
  for (int i = 0; i <= points_x_ / 2; ++i) {
    row = spectrum.row(i);
    transform_.inv(result.data(), row.data(), static_cast<Eigen::Index>(points_y_));
    spectrum.row(i) = result.array().transpose();
  }
  Eigen::ArrayXXd values(points_x_, points_y_);
  for (int j = 0; j < points_y_; ++j)
    real_transform_.inv(values.col(j).data(), spectrum.col(j).data(), static_cast<Eigen::Index>(points_x_));
  return values;
}

}  // namespace triskin::mechanics
