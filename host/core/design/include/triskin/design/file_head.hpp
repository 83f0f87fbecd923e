// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string_view>

#include "triskin/design/json_value.hpp"

/// The head of a file of ours: each has the keys "format" and "version". Constant cost.
namespace triskin::design {

/// Requires that the key "format" of a file is `wanted`. `writer` says what makes such files ("triskin calibrate").
/// Errors: InputError that names both, at this key.
void require_format(const JsonValue& v, std::string_view wanted, std::string_view writer);

/// Requires that the key "version" of a file is `wanted`. `remedy` says what a person does about a file of another
/// version. Errors: InputError that names both versions and the remedy, at this key.
void require_version(const JsonValue& v, int wanted, std::string_view remedy = "use the matching release");

}  // namespace triskin::design
