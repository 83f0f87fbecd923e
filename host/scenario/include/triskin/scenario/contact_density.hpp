// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "triskin/scene/scene.hpp"

namespace triskin::scenario {

/// How long each module of a skin was touched, s, by module.
struct ContactDensity {
  design::Design design;
  std::vector<double> touched_s;
  double duration_s = 0.0;  ///< that was looked at
  [[nodiscard]] std::size_t touched_modules() const;
};

/// Contacts of a scene, from its beginning for `duration_s` ≥ 0; 0: until its last contact ends. A module counts as
/// touched while a pressure taxel of it feels a contact. Throws InputError for a scene without contacts, and for one
/// whose contacts never end if `duration_s` is 0. Cost: contacts · modules, and steps of 10 ms · touched modules.
[[nodiscard]] ContactDensity density_of_scene(const scene::Scene& scene, double duration_s = 0.0);

/// Contacts of a recording (.mcap): a module counts as touched while a pressure taxel reads below its rest value by the
/// threshold of a touch. Throws InputError when it is no recording of triskin. Cost: reads the file.
[[nodiscard]] ContactDensity density_of_recording(const std::filesystem::path& path);

/// Region file (docs/regions.md) in which a module is worth 1 where nothing touched, `max_weight` > 1 where contacts
/// were longest, and in between in proportion to their time: a ball about each touched module. Throws InputError when
/// no module was touched, or for another weight.
[[nodiscard]] std::string regions_text(const ContactDensity& density, double max_weight);

}  // namespace triskin::scenario
