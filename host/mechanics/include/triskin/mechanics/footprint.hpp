// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/mechanics/layer.hpp"

namespace triskin::mechanics {

/// What a round contact of given size does to taxels at a distance, for any force: the linear limit of the layer.
///
/// The contact presses between Hertz' pressure 3F/(2πa²)·√(1 − (r/a)²), which is right if it is small against
/// the thickness h, and the paraboloid 2F/(πa²)·(1 − (r/a)²) of a wide one. The share of the latter is a/(a +
/// 3h); this meets the exact contact of a sphere within a tenth of the peak at a = 2h … 3h (tests/mechanics). The
/// layer spreads the pressure to the displacement of the surface, and a taxel is the mean over its electrode. Values
/// are pressures that would move the taxel as far if they were even, which is what a calibrated taxel reads: their
/// integral over the plane is the force.
///
/// Immutable and thread-safe. Cost of making it: some 20 ms; of a value: two interpolations. Source: Hankel transforms
/// of the pressures, of the disc and of the layer (layer.hpp).
class Footprint {
 public:
  static constexpr double kMinContactRadius_mm = 1.0, kMaxContactRadius_mm = 25.0;

  /// Only thickness and Poisson's ratio of the layer matter. Throws InputError as check(Layer), and unless the disc is
  /// 0.1 … 20 mm across.
  explicit Footprint(const Layer& layer = {}, double disc_diameter_mm = 4.0);
  /// kPa for 1 N at `distance_mm` ≥ 0 from the axis of a contact of the radius, which is taken for the nearest one
  /// between the limits. 0 beyond reach_mm().
  [[nodiscard]] double kpa_per_newton(double contact_radius_mm, double distance_mm) const;
  /// Farthest distance at which a contact of the radius moves a taxel by more than 0.02 % of its largest value.
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
  std::vector<Profile> profiles_;  // One for each radius, which grow by equal factors.
};

}  // namespace triskin::mechanics
