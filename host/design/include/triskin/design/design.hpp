// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "triskin/design/kinds.hpp"
#include "triskin/design/mesh.hpp"
#include "triskin/design/module.hpp"
#include "triskin/design/patch.hpp"
#include "triskin/design/piece.hpp"
#include "triskin/design/price.hpp"
#include "triskin/design/regions.hpp"
#include "triskin/layout/module.hpp"

namespace triskin::design {

/// A layout that was found and not taken, or the one that was: a point of the front of modules against price.
struct Alternative {
  ModuleLayout layout;  ///< Its modules have no metrics and no jumpers, since both are computed when it is taken.
  int patches = 0;
  int jumpers = 0;
  double price = 0.0;         ///< It is the price in modules by Design::price.
  double module_value = 0.0;  ///< It is the value of its modules by Design::regions, or their number without regions.
};

/// Side of a part with a wall that the surface of a design was taken from (docs/side.md).
struct PartSide {
  std::string taken;  ///< It is outer, inner, both, 1 or 2 (of a picture), or from (what is seen from a point).
  bool is_certain = true;
  double wall_mm = 0.0;
  Mesh part;  ///< It is the whole part in mm, and empty with `both`.
};

/// Design of a cover: the only thing that passes between geometry and the device side (docs/design_file.md has the
/// schema). A module is named by its id = index in layout.modules; Patch speaks of nodes, which in a design are the
/// same numbers.
struct Design {
  static constexpr int kVersion = 1;  ///< A file without jumpers has this version.
  /// Version of a file with jumpers; a reader of version 1 would split its patches.
  static constexpr int kJumperVersion = 2;

  /// Figures of the whole design.
  struct Report {
    double area_cm2 = 0.0;
    double coverage = 0.0;  ///< It is modules · 389.7 mm² / area.
    int upper_bound = 0;    ///< It divides the area by that of a module: a yardstick and no proof (docs/lattice.md).
    int patches_lower_bound = 0;
    /// No division into as many patches needs fewer jumpers; in the file only beside jumpers.
    int jumpers_lower_bound = 0;
    double max_edge_error_mm = 0.0, max_hinge_gap_mm = 0.0, max_center_gap_mm = 0.0;
    /// Largest distances of corners and sides above and under the surface; in the file beside their limits only.
    double max_edge_lift_mm = 0.0, max_edge_depth_mm = 0.0;
    double seconds = 0.0;
    /// It is the value of the modules by Design::regions, and in the file only beside regions.
    double module_value = 0.0;
    /// They are must-cover regions that are not covered, and in the file only beside regions.
    std::vector<Uncovered> uncovered;
    /// Patches whose cable enters outside of the regions for it, and in the file only beside such regions.
    std::vector<int> entries_elsewhere;
    /// It is modules · what corner cuts leave of 389.7 mm² / area, and in the file only with a cut.
    double coverage_cut = 0.0;
  };

  /// Faces of a CAD part that the surface is made of.
  struct PartSource {
    std::vector<int> faces;     ///< The chosen faces are named by their index in the part.
    int face_count = 0;         ///< The part has so many faces.
    double deviation_mm = 0.0;  ///< The surface is at most so far from the exact one.
    /// It is a JSON object that says how the faces were chosen (docs/cad.md), to choose again in a later version.
    std::string selection;
  };

  std::string name;
  std::uint64_t design_id = 0;  ///< It is a hash of modules and patches that is flashed into every controller.
  std::string source_file;      ///< It is a name without its folder.
  double scale_to_mm = 1.0;
  std::optional<PartSource> part;  ///< There is none, and no such key in the file, when the source is a mesh.
  std::uint64_t seed = 1;
  Mesh surface;                  ///< It is in mm.
  std::optional<PartSide> side;  ///< There is none, and no key in the file, when the surface has no wall.
  LayoutLimits limits;
  std::vector<PlacedPiece> pieces;
  ModuleLayout layout;  ///< The index of a module is its id.
  std::vector<Patch> patches;
  /// Node address of the controller of each patch, 0 where it hangs on another bus than the one in hand; empty: patch p
  /// has p + 1. A robot file gives addresses (docs/robot_file.md); they are neither in the design file nor in its id.
  std::vector<std::uint8_t> node_addresses;
  KindPlan kinds;   ///< If it is empty, all modules are of the standard kind, and the file has no such key.
  Price price;      ///< These prices of controllers and jumpers are in the file only beside alternatives.
  Regions regions;  ///< Without regions every place is worth the same, and the file has no such key.
  /// Most modules first, falling price. `taken`: index of the one in `layout`, -1 where there are none.
  std::vector<Alternative> alternatives;
  int taken = -1;
  Report report;
};

/// Place of one module in the wiring.
struct ModuleWiring {
  int patch = -1;  ///< It is an index in Design::patches; −1 stands for a module in none.
  RoutedModule routed;
};
/// Wiring by module id, one entry a module. Errors: std::out_of_range for a patch that names a module the layout lacks.
/// Cost: O(n).
[[nodiscard]] std::vector<ModuleWiring> wiring_of(const Design& design);

/// Node address 1 … 126 of the controller of patch `patch` (0-based); 0: it hangs on another bus. Throws
/// std::out_of_range for a patch that has none by Design::node_addresses. Constant cost.
[[nodiscard]] int node_address_of(const Design& design, int patch);
/// The patch whose controller has node address `node`; −1: none. Throws as node_address_of. Cost: O(patches).
[[nodiscard]] int patch_at(const Design& design, int node);
/// Patches whose controllers hang on the bus in hand, ascending; all without Design::node_addresses. Throws as above.
[[nodiscard]] std::vector<int> patches_here(const Design& design);

/// Centre and outward unit normal of a taxel, mesh frame, mm.
struct TaxelPose {
  Vec3 position_mm;
  Vec3 normal;
};
/// The taxels of a module that is turned by `rotation` (port p at tile side (p + rotation) % 3). Positions on the
/// iCub module relative to its centroid: skinGui's triangle (docs/design_file.md). Result by taxel number; constant
/// cost.
[[nodiscard]] std::array<TaxelPose, layout::kTaxelsPerModule> taxels_of(const PlacedModule& module, int rotation);

/// FNV-1a over the modules, jumpers, patches and wiring, in file order, then corner cut and kinds where there are any:
/// equal designs have equal ids on every compiler. Cost: O(n).
[[nodiscard]] std::uint64_t design_id_of(const Design& design);

/// Reads a design file of version kVersion or kJumperVersion and checks its form: types, ranges, indices (not the
/// rules: that is `triskin check`). Errors: InputError naming file and key, for another version naming the remedy.
/// Cost: linear.
[[nodiscard]] Design read_design(const std::filesystem::path& path);
/// The same for a design that is to be deployed: its modules and wiring must be those that its id was made of. Errors
/// besides: InputError when they are not, because the file was changed by hand.
[[nodiscard]] Design read_intact_design(const std::filesystem::path& path);
/// Writes the file whole or not at all. Errors: InputError naming the file when it cannot be written. Cost: linear.
void write_design(const std::filesystem::path& path, const Design& design);

}  // namespace triskin::design
