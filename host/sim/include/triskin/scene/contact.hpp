// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "triskin/design/mesh.hpp"

namespace triskin::scene {

inline constexpr std::uint64_t kForever = ~std::uint64_t{0};

/// Where a moving contact is at one time and how strongly it presses.
struct Keyframe {
  std::uint64_t after_us = 0;  ///< after the beginning of the contact
  design::Vec3 position_mm{0, 0, 0};
  double radius_mm = 6.0;
  double force_n = 2.0;
};

/// A round finger on the skin: Hertz pressure 3F/(2πr²)·√(1 − (d/r)²) at distance d ≤ r from its centre.
struct Contact {
  std::uint64_t from_us = 0;
  std::uint64_t until_us = kForever;    ///< exclusive; end of the first pass of a contact that repeats
  design::Vec3 position_mm{0, 0, 0};    ///< mesh frame
  std::optional<design::Vec3> to_mm{};  ///< moves there at constant speed until `until_us`
  double radius_mm = 6.0;
  double force_n = 2.0;
  std::uint64_t rise_us = 0;  ///< the force grows from 0 for so long
  std::uint64_t fall_us = 0;  ///< the force falls to 0 for so long before `until_us`
  /// Times that do not fall; place, radius and force are linear between them and constant after the last. Where there
  /// are some, `position_mm`, `to_mm`, `radius_mm` and `force_n` do not count.
  std::vector<Keyframe> keyframes{};
  std::uint64_t every_us = 0;  ///< begins anew after so long, at least the time of one pass; 0: once
  int passes = 0;              ///< of a contact that repeats; 0: without end
};

/// A contact at one time.
struct ContactState {
  design::Vec3 position_mm{0, 0, 0};
  double radius_mm = 0.0;
  double force_n = 0.0;
};

/// The contact at virtual time `at_us`; empty: nothing touches then. Cost: O(log keyframes).
[[nodiscard]] std::optional<ContactState> state_of(const Contact& contact, std::uint64_t at_us);

/// Virtual time from which on the contact never touches again; kForever: there is none.
[[nodiscard]] std::uint64_t end_of(const Contact& contact);

/// Distance from a point to the path of the contact's centre, mm. Cost: O(keyframes).
[[nodiscard]] double distance_mm(const Contact& contact, const design::Vec3& point_mm);

/// True if the contact can press at the point at some time. Cost: O(keyframes).
[[nodiscard]] bool reaches(const Contact& contact, const design::Vec3& point_mm);

/// Largest radius of the contact, mm.
[[nodiscard]] double max_radius_mm(const Contact& contact);

}  // namespace triskin::scene
