// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <string_view>

#include "triskin/core/bytes.hpp"

namespace triskin::fuzz {

/// Runs one decoder and tests rules that hold for any input: no crash, and accepted input survives a round trip. A
/// broken rule calls std::abort.
struct Target {
  std::string_view name;
  void (*run)(Bytes input);
};
[[nodiscard]] std::span<const Target> targets();
[[nodiscard]] Target find_target(std::string_view name);

}  // namespace triskin::fuzz
