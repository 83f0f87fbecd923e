// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design.hpp"

namespace triskin::hdf5 {

/// False when this program was built without HDF5; then taxel_table() throws.
[[nodiscard]] bool can_write();

/// The taxels of a design as an HDF5 file (docs/export_hdf5.md), one row a taxel, ordered by module, then taxel. Equal
/// designs give equal bytes with one version of the library: no time is written. Errors: InputError for a design
/// without modules, naming the package when can_write() is false, and when the library reports an error. Cost:
/// O(modules).
[[nodiscard]] std::string taxel_table(const design::Design& design);

}  // namespace triskin::hdf5
