// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

/// Pages of the controller's flash area. docs/flash_layout.md.
namespace triskin::layout {

inline constexpr std::size_t kFirstFaultPage = 4;  ///< number of the first page of the fault memory
inline constexpr std::size_t kFaultPages = 2;      ///< the fault memory fills its pages in turn

}  // namespace triskin::layout
