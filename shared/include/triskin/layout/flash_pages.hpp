// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

/// Pages of the controller's flash area. docs/flash_layout.md.
namespace triskin::layout {

inline constexpr std::size_t kFirstFaultPage = 4;  ///< of the fault memory
inline constexpr std::size_t kFaultPages = 2;      ///< filled in turn

}  // namespace triskin::layout
