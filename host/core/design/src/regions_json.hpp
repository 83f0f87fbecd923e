// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/design/design.hpp"
#include "triskin/design/json_value.hpp"

namespace triskin::design {

/// Adds "regions", and the results for them in the report, to the document of a design that has regions.
void write_regions(const Design& design, nlohmann::json& document);
/// Reads them if the document has them. Errors: InputError naming the key.
void read_regions(const JsonValue& document, Design& design);

}  // namespace triskin::design
