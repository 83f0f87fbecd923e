// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design.hpp"

namespace triskin::hdf5 {

/// Returns false when this program was built without HDF5; then taxel_table() throws.
[[nodiscard]] bool can_write();

/// Writes the taxels of a design as an HDF5 file (docs/exports.md), one row per taxel, ordered by module, then
/// taxel. With one version of the library, equal designs give equal bytes, because no time is written. Errors:
/// InputError for a design without modules, naming the package when can_write() is false, and when the library reports
/// an error. Cost: O(modules).
[[nodiscard]] std::string taxel_table(const design::Design& design);

}  // namespace triskin::hdf5
