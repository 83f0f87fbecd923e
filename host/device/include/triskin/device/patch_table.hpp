// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "triskin/layout/patch_image.hpp"
#include "triskin/model/design.hpp"

namespace triskin::device {

/// What is flashed into the controller of a patch. Throws InputError naming the patch when the design cannot be put into a
/// table: more than 16 modules, more than 126 patches, a place used twice, a joint to a parent that is no neighbour.
[[nodiscard]] layout::PatchImage image_of(const model::Design& design, int patch);

/// The bytes of an image.
[[nodiscard]] std::vector<std::uint8_t> bytes_of(const layout::PatchImage& image);

}  // namespace triskin::device
