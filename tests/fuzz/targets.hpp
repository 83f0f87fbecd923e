// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cstdlib>
#include <span>
#include <string_view>

#include "triskin/core/bytes.hpp"

namespace triskin::fuzz {

/// Ends the program when a rule is broken that holds for any input.
inline void require(bool rule) {
  if (!rule) std::abort();
}

/// Runs one decoder or reader and tests rules that hold for any input: no crash, and accepted input survives a round
/// trip. A broken rule calls std::abort.
struct Target {
  std::string_view name;
  void (*run)(Bytes input);
  int mutations = 20'000;  ///< The test tries so many; the corpus is in tests/fuzz/corpus/<name>.
};
/// Returns the targets of a program. Decoders of a wire and readers of files are in programs of their own.
[[nodiscard]] std::span<const Target> targets();
/// Returns the target with this name, which must exist.
[[nodiscard]] inline Target find_target(std::string_view name) {
  const auto found = std::ranges::find(targets(), name, &Target::name);
  require(found != targets().end());
  return *found;
}

}  // namespace triskin::fuzz
