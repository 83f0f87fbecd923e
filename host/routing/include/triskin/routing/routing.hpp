// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "triskin/base/names.hpp"
#include "triskin/base/progress.hpp"
#include "triskin/design/design_types.hpp"

namespace triskin::geometry {

/// Constants of the electrical rule of a line; sources in docs/routing.md.
struct ElectricalModel {
  double supply_v = 3.3;
  double low_level_v = 0.4;      ///< The I²C specification calls it V_OL.
  double sink_ma = 3.0;          ///< The I²C specification calls it I_OL.
  double bus_hz = 400e3;         ///< The lines must reach this speed.
  double cable_pf_per_m = 60.0;  ///< It is that of the entry cable.
  double cable_m = 0.5;          ///< It is the length of the entry cable if no controller place is given.
  double joint_pf = 2.0;
  double jumper_pf = 2.0;  ///< The two plugs of a jumper add it to that of a joint and of the cable's length.
  double pin_pf = 10.0;    ///< Each module on the line adds its converter and multiplexer.
  double switch_pf = 6.0;  ///< Each module that the line passes adds its bus switch.
  bool all_lines_on_all_joints = true;  ///< If false, a line ends at its last module.
};

/// Order of the secondary objectives of a patch: expected loss (sum of depths) before line hops, or line hops before
/// it.
enum class RouteObjective { kLossFirst, kHopsFirst };

/// How route() divided a graph among controllers: most of its cost, which another call for the same graph, places,
/// capacity, seed and price is spared. Immutable.
class Division;

/// Options of route(). capacity ≤ lines · addresses.
struct RoutingOptions {
  int capacity = kModulesAController;  ///< A patch may have 1 … 16 modules.
  int lines = 4;                       ///< A patch may have 1 … 4 lines.
  int addresses = 4;                   ///< A line may have 1 … 16 addresses.
  std::uint64_t seed = 1;
  bool failure_analysis = true;  ///< It fills Patch::failures, second entries, articulation nodes and bridges.
  RouteObjective objective = RouteObjective::kLossFirst;
  ElectricalModel electrical;
  bool second_entry = true;  ///< A second connector is planned where it saves modules.
  /// Where it saves most, the second connector may lie at the seam to another patch, which no border side reaches.
  bool second_entry_at_seam = true;
  bool adoption = true;  ///< Neighbouring patches with free addresses may read unreachable modules.
  /// A patch gets so many moves that lower the secondary cost; 0 keeps the first partition.
  int recombinations = 60;
  bool has_controller_place = false;      ///< Then cable lengths count in the secondary cost.
  std::array<double, 3> controller_mm{};  ///< It is in the frame of the mesh.
  Price price;      ///< The prices of a controller and a jumper are used only if jumpers are possible.
  int threads = 1;  ///< So many threads (at least 1) divide islands; the result does not depend on their number.
  /// It may be the division of an earlier result for the same graph and places, or null.
  std::shared_ptr<const Division> division;
  /// Asked between the searches for a better division, by any of the threads: true, and the best so far is the answer,
  /// with bounds that hold.
  std::function<bool()> give_up{};
};

/// Proof by which a lower bound of controllers was met, in order of effort.
enum class PartitionProof {
  kSize,      ///< The bound is ⌈modules / capacity⌉.
  kFolding,   ///< The shape forces these parts, as folding branches shows.
  kFrontier,  ///< An exact dynamic programme over frontiers gives the bound.
  kOpen,      ///< The bound is not met, so fewer controllers may do.
};
/// Names in reports: empty while open.
inline constexpr NameTable kPartitionProofNames{
    std::array<std::pair<PartitionProof, std::string_view>, 4>{{{PartitionProof::kSize, "size"},
                                                                {PartitionProof::kFolding, "folding"},
                                                                {PartitionProof::kFrontier, "frontier"},

                                                                {PartitionProof::kOpen, ""}}}};

/// Result of route(). Every node is an index in the nodes of the graph that was given.
struct RoutingResult {
  std::vector<Patch> patches;
  int lower_bound = 0;          ///< No partition has fewer patches.
  bool proved = false;          ///< It says that patches.size() == lower_bound.
  std::vector<Jumper> jumpers;  ///< They are the given places that are fitted, each within one patch.
  int jumpers_lower_bound = 0;  ///< No partition into as many patches has fewer jumpers.
  bool price_proved = false;    ///< No partition costs less for controllers and jumpers together.
  int line_hops = 0;
  int max_depth = 0;
  double mean_loss = 0.0;  ///< extra modules lost, beyond the failed one: mean over all single failures of modules and
                           ///< tree joints, lost_backed_up
  double seconds = 0.0;
  double mean_loss_one_entry = 0.0;  ///< It is the same mean if only the patch itself reroutes.
  double mean_loss_strapped = 0.0;   ///< It is the same mean without rerouting.
  int patches_without_border = 0;
  int electrical_violations = 0;
  /// How the bound was met: the proof that took most effort over the islands.
  PartitionProof proof = PartitionProof::kSize;
  std::shared_ptr<const Division> division;  ///< It is never null.
};

/// Divides the graph into the fewest connected patches and wires each one: border entry, then least lines against the
/// electrical rule, least expected loss (sum of depths), least line hops, least depth; exact over all trees and
/// entries. Deterministic for a seed on every machine and compiler, except where `give_up` says so. Errors: InputError
/// naming the node for joints that are not symmetric or stand twice, and for options out of range or a division of
/// another graph. Thread-safe. Cost: about 0.1 s for 142 modules, 1 s for 2600. Sources: docs/routing.md.
[[nodiscard]] RoutingResult route(const ModuleGraph& graph, const RoutingOptions& options = {},
                                  const ProgressSink& progress = {});
/// The same where jumpers may join islands: `places` as find_jumpers() lists them for the layout that `graph` shows
/// without jumpers. Of controllers and jumpers together the cheapest are fitted (options.price); within a patch the
/// shortest. A jumper counts as a joint in all that follows: trees, lines, failures. With empty places the same as
/// above. Errors besides: std::out_of_range for a place whose node the graph lacks. Cost: 0.05 s more for 150
/// modules, 0.3 s for 230 in 23 islands, up to 1 s where the lowest price is hard to prove.
[[nodiscard]] RoutingResult route(const ModuleGraph& graph, const std::vector<Jumper>& places,
                                  const RoutingOptions& options = {}, const ProgressSink& progress = {});

/// Wiring that is to stay as it is: patches at their index, with no modules where the index is free, and their jumpers.
struct KeptWiring {
  std::vector<Patch> patches;
  std::vector<Jumper> jumpers;
};

/// Wires what `kept` leaves, as route() would wire it alone. Kept patches stay at their index unless there are too few
/// new ones to fill the free places before them; failures are computed for all of them again. `places`: as for route();
/// kept jumpers are among them. Bounds are those of the whole graph; more controllers may be needed than those.
/// Errors: as route(), and std::out_of_range for a kept module that the graph lacks. Cost: twice that of route().
[[nodiscard]] RoutingResult route_around(const ModuleGraph& graph, const std::vector<Jumper>& places,
                                         const KeptWiring& kept, const RoutingOptions& options = {},
                                         const ProgressSink& progress = {});

}  // namespace triskin::geometry
