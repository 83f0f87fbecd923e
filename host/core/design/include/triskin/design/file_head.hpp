// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string_view>

#include "triskin/design/json_value.hpp"

namespace triskin::design {

/// Requires the head of a file of ours: the keys "format" and "version". `remedy` says what a person does about a file
/// of another version. Errors: InputError that names what stands there and what must, at the key. Constant cost.
void require_head(const JsonValue& v, std::string_view format, int version, std::string_view remedy);

}  // namespace triskin::design
