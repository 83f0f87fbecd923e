// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/design/design.hpp"
#include "triskin/design/rest_values.hpp"
#include "triskin/session/bus.hpp"

namespace triskin::device {

/// Where every taxel of a skin rests that nobody touches: the median of three readings, 50 ms apart, of each controller
/// on the bus that holds its table; one that was just switched on is waited for, up to 3 s. A taxel without a valid
/// reading keeps its value of `before`, or the middle of the design (layout::kRestCounts) where that is empty. Throws
/// DeviceError when a controller stops answering, InputError when the design does not fit into tables.
[[nodiscard]] design::RestValues read_rest(Bus& bus, const design::Design& design, design::RestValues before = {});

}  // namespace triskin::device
