// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/mechanics/layer.hpp"

namespace triskin::mechanics {

/// Computes how a round contact moves taxels at a distance, in the linear limit of the layer, for any force.
///
/// The contact presses between Hertz' pressure 3F/(2πa²)·√(1 − (r/a)²), which is right if it is small against
/// the thickness h, and the paraboloid 2F/(πa²)·(1 − (r/a)²) of a wide one. The share of the latter is a/(a +
/// 3h); this meets the exact contact of a sphere within a tenth of the peak at a = 2h … 3h (tests/device/mechanics).
/// The layer spreads the pressure to the displacement of the surface, and a taxel is the mean over its electrode.
/// Values are pressures that would move the taxel as far if they were even, which is what a calibrated taxel reads:
/// their integral over the plane is the force.
///
/// Immutable and thread-safe. Construction takes about 20 ms, a value two interpolations. Source: Hankel transforms of
/// the pressures, of the disc and of the layer (layer.hpp).
class Footprint {
 public:
  static constexpr double kMinContactRadius_mm = 1.0, kMaxContactRadius_mm = 25.0;

  /// Uses only the layer's thickness and Poisson's ratio. Throws InputError as check(Layer) does, and unless the disc
  /// is 0.1 … 20 mm across.
  explicit Footprint(const Layer& layer = {}, double disc_diameter_mm = 4.0);
  /// Returns the pressure in kPa for 1 N at `distance_mm` ≥ 0 from the contact's axis; a radius beyond the limits
  /// counts as the nearest limit. Beyond reach_mm() the result is 0.
  [[nodiscard]] double kpa_per_newton(double contact_radius_mm, double distance_mm) const;
  /// Returns the largest distance at which the contact moves a taxel by more than 0.02 % of its peak value.
  [[nodiscard]] double reach_mm(double contact_radius_mm) const;

 private:
  struct Profile {
    double reach_mm = 0.0;
    std::vector<double> values;
    [[nodiscard]] double at(double distance_mm) const;
  };
  struct Place {
    std::size_t index;
    double share;
  };
  [[nodiscard]] static Place place_of(double contact_radius_mm);
  std::vector<Profile> profiles_;  // The radii of successive profiles grow by equal factors.
};

}  // namespace triskin::mechanics
