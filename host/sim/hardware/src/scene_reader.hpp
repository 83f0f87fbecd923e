// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "triskin/design/json_fields.hpp"
#include "triskin/hardware/scene.hpp"

/// Reads the parts of a scene file. Every function throws InputError naming file, line, key and remedy.
namespace triskin::hardware {

inline constexpr double kMaxScene_s = 1e6;
inline constexpr double kMaxPlace_mm = 1e5;

/// Resolves the names in a scene with the design that they refer to.
struct SceneNames {
  /// `part_name` is empty in a scene of a design.
  explicit SceneNames(const Scene& scene, std::string part_name = {})
      : part(std::move(part_name)),
        design(scene.design),
        switched(scene.switched),
        wiring(design::wiring_of(scene.design)) {}
  /// Returns the module that the value names.
  [[nodiscard]] layout::ModuleId module(const design::JsonValue& v) const;
  [[nodiscard]] layout::PatchIndex patch(const design::JsonValue& v) const;

  std::string part;  ///< The part of a robot that the names belong to.
  const design::Design& design;
  bool switched;
  std::vector<design::ModuleWiring> wiring;
};

void only_scene_keys(const design::JsonValue& v, std::initializer_list<std::string_view> allowed);
/// Fails if the item of a list has the key "part" in a scene of a design.
void require_part_of_robot(const SceneNames& names, const design::JsonValue& v);
/// Converts a time in seconds to µs.
[[nodiscard]] std::uint64_t scene_time_us(const design::JsonValue& v);
/// Reads three lengths in mm.
[[nodiscard]] design::Vec3 scene_point_mm(const design::JsonValue& v);

[[nodiscard]] Contact read_contact(const SceneNames& names, const design::JsonValue& v);
/// Reads the effects of effects.hpp from the keys of "effects".
[[nodiscard]] PadEffects read_pad_effects(const design::JsonValue& v);
/// Reads "converters": "drawn", "ideal", or an object with properties by their keys.
[[nodiscard]] Converters read_converters(const design::JsonValue& v);
[[nodiscard]] Fault read_fault(const SceneNames& names, const design::JsonValue& v);
[[nodiscard]] Expectation read_expectation(const SceneNames& names, const design::JsonValue& v);

}  // namespace triskin::hardware
