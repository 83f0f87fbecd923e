// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "layer_patch.hpp"

namespace triskin::mechanics {

/// Applies the layer's kernels to pressures on a patch that repeats without end. Not thread-safe: the transform keeps
/// its plans.
class LayerConvolution {
 public:
  LayerConvolution(const Layer& layer, const PatchGrid& grid);
  /// Returns the displacement of the surface, mm, under a pressure in kPa.
  [[nodiscard]] Eigen::ArrayXXd displacement(const Eigen::ArrayXXd& pressure_kpa);
  /// Returns the pressure on the base, kPa.
  [[nodiscard]] Eigen::ArrayXXd base_pressure(const Eigen::ArrayXXd& pressure_kpa);

 private:
  using Spectrum = Eigen::ArrayXXcd;
  [[nodiscard]] Spectrum forward(const Eigen::ArrayXXd& values);
  [[nodiscard]] Eigen::ArrayXXd backward(Spectrum spectrum);

  int points_x_, points_y_;
  Eigen::ArrayXXd compliance_, base_;  // The transform of real values needs only half of the wave numbers in x.
  Eigen::FFT<double> real_transform_, transform_;
};

}  // namespace triskin::mechanics
