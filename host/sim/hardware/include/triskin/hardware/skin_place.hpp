// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "triskin/base/format_index.hpp"
#include "triskin/design/design.hpp"
#include "triskin/layout/index.hpp"

namespace triskin::hardware {

/// A place is a point of the skin, that is, of the triangle of a module.
struct SkinPlace {
  design::Vec3 position_mm{0, 0, 0};
  layout::ModuleId module = layout::ModuleId::none();
  double distance_mm = 0.0;  ///< The distance is measured from the requested point or ray.
};

/// Returns the point of the skin nearest to `point_mm` (mesh frame); empty if the design has no module. Cost:
/// O(modules).
[[nodiscard]] std::optional<SkinPlace> nearest_place(const design::Design& design, const design::Vec3& point_mm);

/// A ray that passes beside a module by more than this misses it.
inline constexpr double kMaxGap_mm = 3.0;

/// Returns the first point where a ray from `from_mm` along `direction` meets the skin. A ray through the gap between
/// two modules meets the nearest of them, and `distance_mm` is how far it passes beside the module, at most kMaxGap_mm.
/// Empty if it misses the skin or the direction has no length. Cost: O(modules).
[[nodiscard]] std::optional<SkinPlace> place_on_ray(const design::Design& design, const design::Vec3& from_mm,
                                                    const design::Vec3& direction);

}  // namespace triskin::hardware
