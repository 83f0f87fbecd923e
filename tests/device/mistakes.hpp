// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "triskin/diagnose/verify.hpp"
#include "triskin/scene/scene.hpp"

namespace triskin::test {

/// What a right explanation of a seeded mistake says.
struct Expected {
  device::FindingKind kind;
  std::set<int> modules;  ///< one of them is named, as module or as other; empty: any
  int patch = -1;
  int line = -1;
  [[nodiscard]] bool matches(const device::Finding& f) const;
};

/// A skin as it is built, beside the design it is meant to be.
struct Hardware {
  explicit Hardware(design::Design meant) : intended(std::move(meant)), built(intended) {}
  design::Design intended, built;
  std::vector<scene::Fault> faults;
  std::optional<design::Design> flashed;  ///< another design in the controllers
  bool fresh = false;                     ///< The controllers were never flashed.
  std::uint64_t verify_at_us = 0;         ///< When the verification begins.
  std::set<int> used;                     ///< modules that a mistake already concerns
  std::set<int> used_patches;             ///< patches whose cable or line a mistake concerns

  [[nodiscard]] design::RoutedModule& routed(int module);
  [[nodiscard]] int patch_of(int module) const;
  /// Modules of the tree below `module`, itself included.
  [[nodiscard]] std::vector<int> subtree(int module) const;
};

/// A kind of mistake that people make or hardware suffers. `seed` changes the hardware; empty: not possible there.
struct Mistake {
  std::string_view name;
  std::string_view what;  ///< text for the table
  bool hides_others;      ///< Nothing else can be seen: left out of the pairs.
  std::function<std::optional<Expected>(Hardware&, std::mt19937_64&)> seed;
};
[[nodiscard]] const std::vector<Mistake>& mistakes();

/// Builds the hardware, flashes it, verifies it against the intended design. The mistakes in `faults` that have a time
/// happen one second after the verification began.
[[nodiscard]] device::VerifyResult verify_built(Hardware hardware);

}  // namespace triskin::test
