// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <initializer_list>
#include <string_view>

#include "triskin/design/json_value.hpp"
#include "triskin/design/mesh.hpp"

/// Readers of fields that occur in several of our formats. Each throws InputError "file: path: what is wrong";
/// constant cost.
namespace triskin::design {

/// Reads a number of 16 hexadecimal digits.
[[nodiscard]] std::uint64_t hex64(const JsonValue& v);

/// Coordinates and lengths in a file may not be larger. At this size a double still resolves 2 µm, and lengths in
/// micrometres, as the design id uses them, fit into 64 bits.
inline constexpr double kMaxLength_mm = 1e10;

/// Reads a number in [low, high], in the unit of the field.
[[nodiscard]] double number_in(const JsonValue& v, double low, double high);

/// Reads three numbers, each at most kMaxLength_mm in size.
[[nodiscard]] Vec3 vec3(const JsonValue& v);

/// Throws unless `v` is an object that has only keys of `allowed`, because a misspelt key would silently have no
/// effect. The message names `page`, which describes the format.
void only_keys(const JsonValue& v, std::initializer_list<std::string_view> allowed, std::string_view page);

}  // namespace triskin::design
