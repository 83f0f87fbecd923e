// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/layout/patch_image.hpp"

namespace triskin::device {

/// By which tree a design is read: the normal one, or the one that the design prepared for the failure of a module or
/// of a joint.
struct RouteChoice {
  int module = -1;  ///< −1: normal
  int other = -1;   ///< −1: the module failed; else the joint between the two
  bool operator==(const RouteChoice&) const = default;
};
/// "normal", "backup:MODULE" or "backup:MODULE-MODULE". Throws InputError.
[[nodiscard]] RouteChoice parse_route(const std::string& text);
/// The failure lies in this patch.
[[nodiscard]] bool concerns(const design::Patch& patch, const RouteChoice& choice);

/// What is flashed into the controller of a patch: with a failure, without the modules that it costs. Throws InputError
/// naming the patch when the design cannot be put into a table: more than layout::kMaxModules modules, more than
/// kMaxNodes patches, a place used twice, a joint to a parent that is no neighbour.
[[nodiscard]] layout::PatchImage image_of(const design::Design& design, int patch, const RouteChoice& choice = {});

/// The bytes of an image.
[[nodiscard]] std::vector<std::uint8_t> bytes_of(const layout::PatchImage& image);

}  // namespace triskin::device
