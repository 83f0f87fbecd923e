// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace triskin::layout {

/// Nominal counts of an untouched taxel: the middle of the converter's range, for which the controller aims with an
/// offset (wire/offsets.hpp); real ones rest elsewhere (wire/settled_rest.hpp). Pressure lowers the value.
inline constexpr double kRestCounts = 0x8000;

}  // namespace triskin::layout
