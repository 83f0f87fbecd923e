// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace triskin::layout {

/// Nominal counts of an untouched taxel: the middle of the converter's range, which the controller reaches by an offset
/// (wire/offsets.hpp). Pressure lowers the value.
inline constexpr double kRestCounts = 0x8000;
/// A single taxel can rest this far from the nominal value, because one step of the offset is that large.
inline constexpr double kRestBand_counts = 1'400.0;

}  // namespace triskin::layout
