// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "triskin/design/design.hpp"

namespace triskin::scene {

/// A point of the skin, that is of the triangle of a module.
struct SkinPlace {
  design::Vec3 position_mm{0, 0, 0};
  int module = -1;           ///< id in the design
  double distance_mm = 0.0;  ///< from what was asked for
};

/// The point of the skin nearest to `point_mm` (mesh frame); empty: the design has no module. Cost: O(modules).
[[nodiscard]] std::optional<SkinPlace> nearest_place(const design::Design& design, const design::Vec3& point_mm);

/// The first point where a ray from `from_mm` along `direction` meets the skin. A ray that passes through the gap
/// between two modules meets the nearest of them; `distance_mm` is how far beside it the ray passes, at most
/// kMaxGap_mm. Empty: it passes by the skin, or the direction has no length. Cost: O(modules).
inline constexpr double kMaxGap_mm = 3.0;
[[nodiscard]] std::optional<SkinPlace> place_on_ray(const design::Design& design, const design::Vec3& from_mm,
                                                    const design::Vec3& direction);

}  // namespace triskin::scene
