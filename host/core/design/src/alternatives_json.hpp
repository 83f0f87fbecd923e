// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/design/design.hpp"
#include "triskin/design/json_value.hpp"

namespace triskin::design {

/// Adds "price", "taken" and "alternatives" to the document of a design that has alternatives.
void write_alternatives(const Design& design, nlohmann::json& document);
/// Reads them if the document has them. Errors: InputError naming the key.
void read_alternatives(const JsonValue& document, Design& design);

}  // namespace triskin::design
