// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

/// Pages of the controller's flash area. docs/flash_layout.md.
namespace triskin::layout {

inline constexpr std::size_t kFirstFaultPage = 4;
/// The fault memory fills its pages in turn, so that one is always readable.
inline constexpr std::size_t kFaultPages = 2;

}  // namespace triskin::layout
