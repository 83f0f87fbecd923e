// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace triskin::mechanics {

/// The soft dielectric is an isotropic, linear elastic layer that is bonded to the rigid cover and extends without end
/// sideways.
struct Layer {
  double thickness_mm = 2.0;
  double poisson = 0.3;  ///< Poisson's ratio must be at least 0 and below 0.5.
  double modulus_kpa = 100.0;
};

/// Throws InputError that names the quantity and its range unless the thickness and the modulus are positive and finite
/// and Poisson's ratio is at least 0 and below 0.5.
void check(const Layer& layer);

/// Returns the stiffness of the layer when it cannot move sideways, in kPa: E(1 − ν) / ((1 + ν)(1 − 2ν)). A
/// uniform pressure p compresses the layer by h·p / K, and the integral of the displacement under any load is F·h /
/// K.
[[nodiscard]] double confined_modulus_kpa(const Layer& layer);

/// Returns 2(1 − ν²) / E in 1/kPa: the transformed displacement of an elastic half-space, times wave number over
/// pressure.
[[nodiscard]] double half_space_compliance_per_kpa(const Layer& layer);

/// Evaluates the kernel of the bonded layer. A pressure cos(kx) on its surface displaces the surface by
/// half_space_compliance · compliance_ratio(kh) / k · cos(kx) and reaches the base as base_pressure_ratio(kh) ·
/// cos(kx). `wave_number` is kh, without unit, at least 0. The first runs from 0 to 1, the second from 1 to 0. Source:
/// derived from the Airy stress function with u = 0 on the base and no shear on the surface; the first agrees with
/// Burmister, J. Appl. Phys. 16 (1945) 89 for a rigid base. Cost: two exponentials. Thread-safe.
[[nodiscard]] double compliance_ratio(double wave_number, double poisson);
[[nodiscard]] double base_pressure_ratio(double wave_number, double poisson);

/// Returns 1 − compliance_ratio without cancellation; it falls as exp(−2kh).
[[nodiscard]] double compliance_deficit(double wave_number, double poisson);

}  // namespace triskin::mechanics
