// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "triskin/hardware/scene.hpp"

namespace triskin::scenario {

/// The density says for how many seconds each module of a skin was touched, indexed by module.
struct ContactDensity {
  design::Design design;
  std::vector<double> touched_s;
  double duration_s = 0.0;  ///< The scene or recording was evaluated for this long.
  [[nodiscard]] std::size_t touched_modules() const;
};

/// Measures the contacts of a scene from its beginning for `duration_s` ≥ 0; 0 means until its last contact ends. A
/// module counts as touched while one of its pressure taxels feels a contact. Throws InputError for a scene without
/// contacts, and for one whose contacts never end if `duration_s` is 0. Cost: contacts · modules, and steps of 10 ms
/// · touched modules.
[[nodiscard]] ContactDensity density_of_scene(const hardware::Scene& scene, double duration_s = 0.0);

/// Measures the contacts of a recording (.mcap): a module counts as touched while a pressure taxel reads below its rest
/// value by the threshold of a touch. Throws InputError when it is not a recording of triskin. Cost: reads the file.
[[nodiscard]] ContactDensity density_of_recording(const std::filesystem::path& path);

/// Formats a region file (docs/regions.md) with a ball around each touched module. A module has the value 1 where
/// nothing touched, `max_weight` > 1 where contacts were longest, and in between in proportion to their time. Throws
/// InputError when no module was touched, or for another weight.
[[nodiscard]] std::string regions_text(const ContactDensity& density, double max_weight);

}  // namespace triskin::scenario
