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
#include "triskin/hardware/scene.hpp"

namespace triskin::test {

/// States what a right explanation of a seeded mistake says.
struct Expected {
  diagnose::FindingKind kind;
  std::set<int> modules;  ///< The explanation must name one of these, as module or as other; empty accepts any.
  int patch = -1;
  int line = -1;
  [[nodiscard]] bool matches(const diagnose::Finding& f) const;
};

/// Describes a skin as it was built, beside the design that was intended.
struct Hardware {
  explicit Hardware(design::Design meant) : intended(std::move(meant)), built(intended) {}
  design::Design intended, built;
  std::vector<hardware::Fault> faults;
  std::optional<design::Design> flashed;  ///< The controllers were flashed with this other design.
  bool fresh = false;                     ///< True means that the controllers were never flashed.
  std::uint64_t verify_at_us = 0;         ///< The verification begins at this time.
  std::set<int> used;                     ///< A mistake already concerns these modules.
  std::set<int> used_patches;             ///< A mistake concerns the cable or line of these patches.

  [[nodiscard]] design::RoutedModule& routed(int module);
  [[nodiscard]] int patch_of(int module) const;
  /// Returns the modules of the tree below `module`, itself included.
  [[nodiscard]] std::vector<int> subtree(int module) const;
};

/// Describes a kind of mistake that people make or hardware suffers. `seed` changes the hardware; it returns an empty
/// value if that is not possible there.
struct Mistake {
  std::string_view name;
  std::string_view what;  ///< The table shows this text.
  bool hides_others;      ///< True means that the mistake hides all others, so it is left out of the pairs.
  std::function<std::optional<Expected>(Hardware&, std::mt19937_64&)> seed;
};
[[nodiscard]] const std::vector<Mistake>& mistakes();

/// Builds the hardware, flashes it, and verifies it against the intended design. Mistakes in `faults` that have a time
/// happen one second after the verification began.
[[nodiscard]] diagnose::VerifyResult verify_built(Hardware hardware);

}  // namespace triskin::test
