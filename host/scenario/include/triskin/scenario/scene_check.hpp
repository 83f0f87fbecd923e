// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/scene/scene.hpp"

namespace triskin::scenario {

/// What became of one expectation of a scene.
struct ExpectationResult {
  scene::Expectation expectation;
  bool held = false;
  std::size_t samples = 0;  ///< that counted
  std::string seen;         ///< what the skin reported, as a sentence
};

struct SceneCheck {
  std::vector<ExpectationResult> results;  ///< in the order of the scene
  double simulated_s = 0.0;
  /// Number of expectations that did not hold.
  [[nodiscard]] std::size_t failed() const;
};

/// Runs a scene and holds what the skin reports against its expectations (RunningSkin). An expectation for which no
/// sample came has not held, unless it expects none. Throws InputError for a scene that expects nothing; otherwise as
/// RunningSkin. Cost: virtual time until the last expectation.
[[nodiscard]] SceneCheck check_scene(scene::Scene scene, const ProgressSink& progress = {});

}  // namespace triskin::scenario
