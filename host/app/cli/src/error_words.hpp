// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

namespace triskin::cli {

/// Rewrites an error message of CLI11 for a person: ranges become short numbers with their unit, and names of types
/// disappear. "--x: Value 5 not in range 0.000000 to 1.000000" becomes "--x: 5 is not between 0 and 1". A message of
/// another form is returned unchanged.
[[nodiscard]] std::string plain_words(const std::string& message);

}  // namespace triskin::cli
