// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace triskin::layout {

/// Where a taxel that nobody touches reads by design, counts of the converter; pressure lowers it. Single taxels differ.
inline constexpr double kRestCounts = 0x8000 + 8000;

}  // namespace triskin::layout
