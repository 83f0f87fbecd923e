// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/layout/patch_image.hpp"

namespace triskin::device {

/// Tree by which a design is read: the normal one, or the one that the design prepared for the failure of a module or
/// of a joint.
struct RouteChoice {
  int module = -1;  ///< It is −1 for the normal route.
  int other = -1;   ///< It is −1 where the module itself failed, otherwise the joint between the two failed.
  bool operator==(const RouteChoice&) const = default;
};
/// Choice written as "normal", "backup:MODULE" or "backup:MODULE-MODULE" (ids in the design). Throws InputError.
[[nodiscard]] RouteChoice parse_route(const std::string& text);
/// True: the failed module, or both modules of the failed joint, belong to `patch`.
[[nodiscard]] bool concerns(const design::Patch& patch, const RouteChoice& choice);

/// Table of the controller of patch `patch` (0-based), with the node address of design::node_address_of; after a
/// failure without the modules that the failure costs, so that its rows are no longer those of the design's patch.
/// Throws InputError naming the patch when the design does not fit into a table: no module or more than
/// layout::kMaxModules, more than layout::kMaxNodes patches, module ids beyond those that a table can name, a line and
/// address used twice, a parent that is no neighbour or stands behind its child, a failed entry module;
/// std::out_of_range for a patch that the design lacks.
[[nodiscard]] layout::PatchImage image_of(const design::Design& design, int patch, const RouteChoice& choice = {});

/// Module of a row of a table of `design`: the id without the number of the kind. Constant cost.
[[nodiscard]] int module_of(const design::Design& design, const layout::ModuleRow& row);
/// Number of its kind; 0 for a design without kinds. It may be one that the design lacks. Constant cost.
[[nodiscard]] int kind_of_row(const design::Design& design, const layout::ModuleRow& row);

/// Bytes of an image as they are flashed (docs/flash_layout.md). Throws InputError when it cannot be encoded.
[[nodiscard]] std::vector<std::uint8_t> bytes_of(const layout::PatchImage& image);

/// True: a table with the checksum `crc` is `image`, or `image` for electrodes at the other input of the converters,
/// which is the hardware's choice and not the design's (triskin flash --positive-input). Throws InputError.
[[nodiscard]] bool holds_image(std::uint32_t crc, const layout::PatchImage& image);

}  // namespace triskin::device
