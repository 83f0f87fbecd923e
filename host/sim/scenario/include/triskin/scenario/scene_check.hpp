// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/hardware/joint_scene.hpp"
#include "triskin/hardware/scene.hpp"

namespace triskin::scenario {

/// Each expectation of a scene has one result.
struct ExpectationResult {
  hardware::Expectation expectation;
  bool held = false;
  std::size_t samples = 0;  ///< The expectation was checked with this many samples.
  std::string seen;         ///< The sentence says what the skin reported.
};

struct SceneCheck {
  std::vector<ExpectationResult> results;  ///< Results are in the order of the scene.
  double simulated_s = 0.0;
  /// Counts the expectations that did not hold.
  [[nodiscard]] std::size_t failed() const;
};

/// Runs a scene and compares the reports of the skin with its expectations (RunningSkin). An expectation for which no
/// sample arrived does not hold, unless it expects none. Throws InputError for a scene without expectations; otherwise
/// as RunningSkin. Cost: virtual time until the last expectation.
[[nodiscard]] SceneCheck check_scene(hardware::Scene scene, const ProgressSink& progress = {});

/// Runs the buses of a robot side by side, in the same virtual time, and does the same with `expectations`, whose parts
/// are covers of the buses. A cover may be on several buses. Throws InputError for an expectation on a part that no bus
/// has, and as above.
[[nodiscard]] SceneCheck check_buses(std::vector<hardware::JointScene> buses,
                                     const std::vector<hardware::Expectation>& expectations,
                                     const ProgressSink& progress = {});

}  // namespace triskin::scenario
