// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace triskin::layout {

/// Nominal value of a taxel that nobody touches, counts of the converter: the middle of its range, to which the
/// controller brings it by an offset (wire/offsets.hpp). Pressure lowers it.
inline constexpr double kRestCounts = 0x8000;
/// How far single taxels rest from it: one step of the offset.
inline constexpr double kRestBand_counts = 1'400.0;

}  // namespace triskin::layout
