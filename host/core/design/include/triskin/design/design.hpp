// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/design/kinds.hpp"
#include "triskin/design/mesh.hpp"
#include "triskin/design/module.hpp"
#include "triskin/design/patch.hpp"
#include "triskin/design/piece.hpp"
#include "triskin/design/price.hpp"
#include "triskin/design/regions.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/layout/module.hpp"

namespace triskin::design {

/// A layout on the Pareto front of modules against price is an alternative; one of them was chosen for the design.
struct Alternative {
  /// The modules have no metrics and the layout has no jumpers, because both are computed when it is chosen.
  ModuleLayout layout;
  int patches = 0;
  int jumpers = 0;
  double price = 0.0;         ///< Design::price gives the price in modules.
  double module_value = 0.0;  ///< Design::regions gives the value; without regions it is the number of modules.
};

/// The surface of a design was taken from this side of a walled part (docs/mesh.md).
struct PartSide {
  /// The text is outer, inner, both, 1 or 2 (sides in a picture), or from (what is seen from a point).
  std::string taken;
  bool is_certain = true;
  double wall_mm = 0.0;
  Mesh part;  ///< The whole part is kept in mm; with `both` the mesh is empty.
};

/// The offsets are added to the ids of a cover's modules, patches and islands in a joint design.
struct CoverOffset {
  layout::SkinModule module;
  int patch = 0, island = 0;
};
/// A cover of a joint design, and where its ids begin in it.
struct NamedCover {
  std::string name;
  CoverOffset first;
};

/// Design of a cover: the only data that geometry hands to the device side (docs/design_file.md has the schema). The id
/// of a module is its index in layout.modules; in a design, the nodes of Patch are these ids.
struct Design {
  static constexpr int kVersion = 1;  ///< Files without jumpers have this version.
  /// Files with jumpers have this version, because a reader of version 1 would split their patches.
  static constexpr int kJumperVersion = 2;

  /// The report has figures for the whole design.
  struct Report {
    double area_cm2 = 0.0;
    double coverage = 0.0;  ///< Coverage is modules · 389.7 mm² / area.
    /// The bound is the area divided by that of a module: a yardstick, not a proof (docs/lattice.md).
    int upper_bound = 0;
    int patches_lower_bound = 0;
    /// The same number of patches cannot be connected with fewer jumpers; the file has it only beside jumpers.
    int jumpers_lower_bound = 0;
    double max_edge_error_mm = 0.0, max_hinge_gap_mm = 0.0, max_center_gap_mm = 0.0;
    /// Corners and sides are at most this far above and below the surface; the file has them only beside their limits.
    double max_edge_lift_mm = 0.0, max_edge_depth_mm = 0.0;
    double seconds = 0.0;
    /// Design::regions gives the value of the modules; the file has it only beside regions.
    double module_value = 0.0;
    /// These must-cover regions are not covered; the file lists them only beside regions.
    std::vector<Uncovered> uncovered;
    /// The cables of these patches enter outside the entry regions; the file lists them only beside such regions.
    std::vector<int> entries_elsewhere;
    /// It is modules · what corner cuts leave of 389.7 mm² / area, and in the file only with a cut.
    double coverage_cut = 0.0;
  };

  /// The surface is made from these faces of a CAD part.
  struct PartSource {
    std::vector<BrepFaceIndex> faces;  ///< These faces of the part were chosen.
    int face_count = 0;                ///< The part has this many faces in total.
    double deviation_mm = 0.0;         ///< The surface deviates from the exact one by at most this distance.
    /// A JSON object records how the faces were chosen (docs/cad.md), so that a later version of the part can be
    /// treated alike.
    std::string selection;
  };

  std::string name;
  std::uint64_t design_id = 0;  ///< The hash of modules and patches is flashed into every controller.
  std::string source_file;      ///< The name does not include the folder.
  double scale_to_mm = 1.0;
  std::optional<PartSource> part;  ///< The file has no such key when the source is a mesh.
  std::uint64_t seed = 1;
  Mesh surface;                  ///< The surface is in mm, in the frame of the mesh.
  std::optional<PartSide> side;  ///< The file has no such key when the surface has no wall.
  LayoutLimits limits;
  std::vector<PlacedPiece> pieces;
  ModuleLayout layout;
  /// Numbers below this one were given to modules that are gone; next_number() (module_number.hpp) is the next free
  /// one.
  int next_number = 0;
  std::vector<Patch> patches;  ///< by the number of their controller; some may be gaps (Patch::is_gap), the last is not
  /// Those that side_by_side() joined, ascending; a design file has none. Numbers are those of the covers, so that a
  /// module is named by both.
  std::vector<NamedCover> covers;
  /// Each patch's controller has its node address here; 0 means that it is on another bus than the current one. If the
  /// list is empty, patch p has address p + 1. A robot file assigns the addresses (docs/robot.md), so they are
  /// neither in the design file nor in its id.
  std::vector<std::uint8_t> node_addresses;
  KindPlan kinds;   ///< An empty plan means that all modules are of the standard kind; the file then has no such key.
  Price price;      ///< The file has the prices of controllers and jumpers only beside alternatives.
  Regions regions;  ///< Without regions all places have the same value, and the file has no such key.
  /// The list begins with most modules and the highest price. `taken` is the index of the one in `layout`; −1 means
  /// that there are no alternatives.
  std::vector<Alternative> alternatives;
  int taken = -1;
  Report report;
};

/// Each module has one position in the wiring.
struct ModuleWiring {
  layout::PatchIndex patch = layout::PatchIndex::none();  ///< −1 means that the module is in no patch.
  RoutedModule routed;
};
/// Returns the wiring of each module, indexed by its id. Errors: std::out_of_range for a patch that names a module the
/// layout lacks. Cost: O(n).
[[nodiscard]] std::vector<ModuleWiring> wiring_of(const Design& design);

/// Returns the numbers of all controllers, ascending. Cost: O(patches).
[[nodiscard]] std::vector<layout::PatchIndex> patches_of(const Design& design);
/// Returns whether there is a controller with this number. Constant cost.
[[nodiscard]] bool has_patch(const Design& design, int patch);
/// Writes the numbers of all controllers as ranges, "0-3,5", for messages.
[[nodiscard]] std::string patch_numbers(const Design& design);

/// Returns the node address 1 … 126 of the controller of patch `patch` (0-based), or 0 if it is on another bus or the
/// number has no controller. Throws std::out_of_range for a patch that the design lacks. Constant cost.
[[nodiscard]] layout::NodeAddress node_address_of(const Design& design, layout::PatchIndex patch);
/// Returns the patch whose controller has node address `node`, or −1. Throws as node_address_of. Cost: O(patches).
[[nodiscard]] layout::PatchIndex patch_at(const Design& design, layout::NodeAddress node);
/// Returns the patches whose controllers are on the current bus, ascending; without Design::node_addresses these are
/// patches_of(). Throws as node_address_of.
[[nodiscard]] std::vector<layout::PatchIndex> patches_here(const Design& design);

/// The centre (mm) and the outward unit normal of a taxel are in the mesh frame.
struct TaxelPose {
  Vec3 position_mm;
  Vec3 normal;
};
/// Returns the taxels, by number, of a module that is turned by `rotation` (port p at tile side (p + rotation) % 3).
/// Their positions relative to the centroid are those of skinGui's triangle of the iCub (docs/design_file.md). Constant
/// cost.
[[nodiscard]] std::array<TaxelPose, layout::kTaxelsPerModule> taxels_of(const PlacedModule& module, int rotation);

/// Computes FNV-1a over the modules, jumpers, patches and wiring in file order, then over corner cut, kinds, numbers
/// with gaps and a later next number, where there are any. Equal designs have equal ids on every compiler. Cost: O(n).
[[nodiscard]] std::uint64_t design_id_of(const Design& design);

/// Reads a design file of version kVersion or kJumperVersion and checks types, ranges and indices; `triskin check`
/// checks the rules. Errors: InputError naming file and key, and for another version the remedy. Cost: linear.
[[nodiscard]] Design read_design(const std::filesystem::path& path);
/// Reads a design that will be deployed; its id must match its modules and wiring. Errors: those of read_design, and
/// InputError when the id does not match, because the file was changed by hand.
[[nodiscard]] Design read_intact_design(const std::filesystem::path& path);
/// Writes the file completely or not at all. Errors: InputError naming the file when it cannot be written. Cost:
/// linear.
void write_design(const std::filesystem::path& path, const Design& design);

}  // namespace triskin::design
