// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace triskin {

/// Returns the name in `names` that `word` was probably meant to be: the one with the fewest letters inserted, deleted,
/// replaced or swapped with the next, if these are at most a third of the `typed` letters and at least one is allowed.
/// Returns an empty text if no name is similar enough. Cost: |names| · |word| · |name|.
[[nodiscard]] std::string nearest_name(const std::string& word, const std::vector<std::string>& names,
                                       std::size_t typed);

}  // namespace triskin
