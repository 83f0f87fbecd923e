// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/design/design.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/layout/patch_image.hpp"

namespace triskin::session {

/// A controller without a table does not sample, so identify() gives it one with this design id until it gets the table
/// of a patch. Such a controller counts as new.
// In the table these bytes read "IDENTIFY".
inline constexpr std::uint64_t kIdentifyDesign = 0x59464954'4E454449ULL;

/// Selects the tree by which a design is read: the normal one, or one that the design prepared for the failure of a
/// module or joint.
struct RouteChoice {
  layout::ModuleId module = layout::ModuleId::none();  ///< −1 selects the normal route.
  /// −1 means that the module itself failed, otherwise the joint between the two failed.
  layout::ModuleId other = layout::ModuleId::none();
  bool operator==(const RouteChoice&) const = default;
};
/// Parses a choice written as "normal", "backup:MODULE" or "backup:MODULE-MODULE", with numbers of modules. Throws
/// InputError, also for a module that the design lacks.
[[nodiscard]] RouteChoice parse_route(const std::string& text, const design::Design& design);
/// Returns true if the failed module, or both modules of the failed joint, belong to `patch`.
[[nodiscard]] bool concerns(const design::Patch& patch, const RouteChoice& choice);

/// Makes the table for the controller of patch `patch` (0-based), with the node address of design::node_address_of.
/// After a failure the lost modules are left out, so that rows differ from those of the design's patch. Throws
/// InputError naming the patch when the design does not fit into a table: no module or more than layout::kMaxModules,
/// more than layout::kMaxNodes patches, module numbers beyond those that a table can name, a line and address used
/// twice, a parent that is no neighbour or is listed after its child, a failed entry module; std::out_of_range for a
/// patch that the design lacks.
[[nodiscard]] layout::PatchImage image_of(const design::Design& design, layout::PatchIndex patch,
                                          const RouteChoice& choice = {});

/// Returns the patch whose normal table for the controller at `node` has the checksum `crc`; −1 if none has. The
/// addresses in the design do not matter, because a robot file may have given others when the table was written. Throws
/// as image_of. Cost: one image for each patch.
[[nodiscard]] layout::PatchIndex patch_of_table(const design::Design& design, layout::NodeAddress node,
                                                std::uint32_t crc);

/// Returns the module of a row of a table of `design`, which has its number beside that of the kind; −1 if the design
/// lacks it. Cost: O(log n).
[[nodiscard]] layout::ModuleId module_of(const design::Design& design, const layout::ModuleRow& row);
/// Returns the number of the module's kind; 0 for a design without kinds. The design may lack that kind. Constant cost.
[[nodiscard]] int kind_of_row(const design::Design& design, const layout::ModuleRow& row);

/// Encodes an image as it is flashed (docs/flash_layout.md). Throws InputError when it cannot be encoded.
[[nodiscard]] std::vector<std::uint8_t> bytes_of(const layout::PatchImage& image);

/// Returns true if a table with the checksum `crc` is `image`, either for the negative or for the positive input of the
/// converters; the input depends on the hardware, not on the design (triskin flash --positive-input). Throws
/// InputError.
[[nodiscard]] bool holds_image(std::uint32_t crc, const layout::PatchImage& image);

}  // namespace triskin::session
