// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

namespace triskin::cli {

/// What CLI11 says of a command line, in words for a person: ranges as short numbers with their unit, no names of
/// types.
/// "--x: Value 5 not in range 0.000000 to 1.000000" becomes "--x: 5 is not between 0 and 1". A message of another form
/// stays as it is.
[[nodiscard]] std::string plain_words(const std::string& message);

}  // namespace triskin::cli
