// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

/// Assigns the pages of the controller's flash area (docs/flash_layout.md).
namespace triskin::layout {

inline constexpr std::size_t kFirstFaultPage = 4;
/// The fault memory alternates between its pages, so that one of them is always readable.
inline constexpr std::size_t kFaultPages = 2;

}  // namespace triskin::layout
