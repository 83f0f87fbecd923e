// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "triskin/design/mesh.hpp"

namespace triskin::hardware {

inline constexpr std::uint64_t kForever = ~std::uint64_t{0};

/// A moving contact has this place and force at one time.
struct Keyframe {
  std::uint64_t after_us = 0;  ///< The time counts from the beginning of the contact.
  design::Vec3 position_mm{0, 0, 0};
  double radius_mm = 6.0;
  double force_n = 2.0;
};

/// A contact is a round finger on the skin with Hertz pressure 3F/(2πr²)·√(1 − (d/r)²) at distance d ≤ r from
/// its centre.
struct Contact {
  std::uint64_t from_us = 0;
  /// The end is exclusive; for a repeating contact it is the end of the first pass.
  std::uint64_t until_us = kForever;
  design::Vec3 position_mm{0, 0, 0};    ///< The position is in the mesh frame.
  std::optional<design::Vec3> to_mm{};  ///< If set, the contact moves there at constant speed until `until_us`.
  double radius_mm = 6.0;
  double force_n = 2.0;
  std::uint64_t rise_us = 0;  ///< The force grows from 0 during this time.
  std::uint64_t fall_us = 0;  ///< The force falls to 0 during this time before `until_us`.
  /// Times must not decrease; place, radius and force are linear between them and constant after the last. If there are
  /// keyframes, `position_mm`, `to_mm`, `radius_mm` and `force_n` are ignored.
  std::vector<Keyframe> keyframes{};
  /// The contact repeats at this interval, which is at least the time of one pass; 0 means that it does not repeat.
  std::uint64_t every_us = 0;
  int passes = 0;  ///< A repeating contact has this many passes; 0 means no end.
};

struct ContactState {
  design::Vec3 position_mm{0, 0, 0};
  double radius_mm = 0.0;
  double force_n = 0.0;
};

/// Returns the contact at virtual time `at_us`; empty if nothing touches then. Cost: O(log keyframes).
[[nodiscard]] std::optional<ContactState> state_of(const Contact& contact, std::uint64_t at_us);

/// Returns the virtual time after which the contact never touches again; kForever if there is none.
[[nodiscard]] std::uint64_t end_of(const Contact& contact);

/// Returns the distance in mm from a point to the path of the contact's centre. Cost: O(keyframes).
[[nodiscard]] double distance_mm(const Contact& contact, const design::Vec3& point_mm);

/// Returns true if the contact can press at the point at some time. Cost: O(keyframes).
[[nodiscard]] bool reaches(const Contact& contact, const design::Vec3& point_mm);

/// Returns the largest radius of the contact in mm.
[[nodiscard]] double max_radius_mm(const Contact& contact);

}  // namespace triskin::hardware
