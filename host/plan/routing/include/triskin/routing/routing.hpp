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

namespace triskin::routing {

/// docs/routing.md gives the sources of these constants.
struct ElectricalModel {
  double supply_v = 3.3;
  double low_level_v = 0.4;      ///< The I²C specification calls it V_OL.
  double sink_ma = 3.0;          ///< The I²C specification calls it I_OL.
  double bus_hz = 400e3;         ///< The lines must reach this speed.
  double cable_pf_per_m = 60.0;  ///< The value applies to the entry cable.
  double cable_m = 0.5;          ///< The entry cable has this length unless a controller place is given.
  double joint_pf = 2.0;
  double jumper_pf = 2.0;  ///< The two plugs of a jumper add this capacitance to that of a joint and of the cable.
  double pin_pf = 10.0;    ///< Each module on the line adds its converter and multiplexer.
  double switch_pf = 6.0;  ///< Each module that the line passes adds its bus switch.
  bool all_lines_on_all_joints = true;  ///< If false, a line ends at its last module.
};

/// Tells whether expected loss (sum of depths) comes before line hops among the secondary objectives of a patch, or
/// after.
enum class RouteObjective { kLossFirst, kHopsFirst };

/// Keeps how route() divided a graph among controllers. This is most of its cost; another call for the same graph,
/// places, capacity, seed and price can reuse it. Immutable.
class Division;

/// capacity must not exceed lines · addresses.
struct RoutingOptions {
  int capacity = kModulesAController;  ///< A patch may have 1 … 16 modules.
  int lines = 4;                       ///< A patch may have 1 … 4 lines.
  int addresses = 4;                   ///< A line may have 1 … 16 addresses.
  std::uint64_t seed = 1;
  bool failure_analysis = true;  ///< True fills Patch::failures, second entries, articulation nodes and bridges.
  RouteObjective objective = RouteObjective::kLossFirst;
  ElectricalModel electrical;
  bool second_entry = true;  ///< A second connector is planned where it saves modules.
  /// Allows the second connector at a seam to another patch if that saves most, although no border is there.
  bool second_entry_at_seam = true;
  bool adoption = true;  ///< Neighbouring patches with free addresses may read modules that lost their own path.
  /// A patch gets so many moves that lower the secondary cost; 0 keeps the first partition.
  int recombinations = 60;
  bool has_controller_place = false;      ///< True counts cable lengths in the secondary cost.
  std::array<double, 3> controller_mm{};  ///< The place is given in the frame of the mesh.
  Price price;      ///< The prices of a controller and a jumper are used only if jumpers are possible.
  int threads = 1;  ///< This many threads (at least 1) divide islands; the result does not depend on their number.
  /// May be the division of an earlier result for the same graph and places, or null.
  std::shared_ptr<const Division> division;
  /// Asked between the searches for a better division, by any of the threads. If it returns true, the best division so
  /// far is the answer, with bounds that hold.
  std::function<bool()> give_up{};
};

/// Tells by which proof a lower bound of controllers was met, in order of effort.
enum class PartitionProof {
  kSize,      ///< The bound is ⌈modules / capacity⌉.
  kFolding,   ///< The shape forces these parts, as folding branches shows.
  kFrontier,  ///< An exact dynamic programme over frontiers gives the bound.
  kOpen,      ///< The bound is not met, so fewer controllers may be enough.
};
/// Reports use these names; an open proof has an empty one.
inline constexpr NameTable kPartitionProofNames{
    std::array<std::pair<PartitionProof, std::string_view>, 4>{{{PartitionProof::kSize, "size"},
                                                                {PartitionProof::kFolding, "folding"},
                                                                {PartitionProof::kFrontier, "frontier"},

                                                                {PartitionProof::kOpen, ""}}}};

/// Every node is an index in the nodes of the given graph.
struct RoutingResult {
  std::vector<Patch> patches;
  int lower_bound = 0;          ///< No partition has fewer patches.
  bool proved = false;          ///< True means that patches.size() == lower_bound.
  std::vector<Jumper> jumpers;  ///< These are the given places at which a jumper is fitted, each within one patch.
  int jumpers_lower_bound = 0;  ///< No partition into as many patches has fewer jumpers.
  bool price_proved = false;    ///< No partition costs less for controllers and jumpers together.
  int line_hops = 0;
  int max_depth = 0;
  /// Modules lost beyond the failed one, averaged over all single failures of modules and tree joints (lost_backed_up).
  double mean_loss = 0.0;
  double seconds = 0.0;
  double mean_loss_one_entry = 0.0;  ///< The mean is taken as if only the patch itself rerouted.
  double mean_loss_strapped = 0.0;   ///< The mean is taken as if nothing rerouted.
  int patches_without_border = 0;
  int electrical_violations = 0;
  /// The proof is the one that took most effort over the islands.
  PartitionProof proof = PartitionProof::kSize;
  std::shared_ptr<const Division> division;  ///< The pointer is never null.
};

/// Divides the graph into the fewest connected patches and wires each one: border entry, then least lines against the
/// electrical rule, least expected loss (sum of depths), least line hops, least depth; exact over all trees and
/// entries. Deterministic for a seed on every machine and compiler, unless `give_up` ends it. Errors: InputError naming
/// the node for joints that are not symmetric or occur twice, and for options out of range or a division of another
/// graph. Thread-safe. Cost: about 0.1 s for 142 modules, 1 s for 2600. Sources: docs/routing.md.
[[nodiscard]] RoutingResult route(const ModuleGraph& graph, const RoutingOptions& options = {},
                                  const ProgressSink& progress = {});
/// Does the same if jumpers may join islands: `places` as find_jumpers() lists them for the layout that `graph` shows
/// without jumpers. The cheapest combination of controllers and jumpers is fitted (options.price); within a patch the
/// shortest jumpers. A jumper counts as a joint in all later steps: trees, lines, failures. With empty places the
/// result is the same as above. Further errors: std::out_of_range for a place whose node the graph lacks. Cost: 0.05 s
/// more for 150 modules, 0.3 s for 230 in 23 islands, up to 1 s if the lowest price is hard to prove.
[[nodiscard]] RoutingResult route(const ModuleGraph& graph, const std::vector<Jumper>& places,
                                  const RoutingOptions& options = {}, const ProgressSink& progress = {});

/// States wiring that is to remain: patches at their index, without modules if the index is free, and their jumpers.
struct KeptWiring {
  std::vector<Patch> patches;
  std::vector<Jumper> jumpers;
};

/// Wires the modules outside `kept`, as route() would wire them alone. Kept patches stay at their index; new ones take
/// the free places first, and those left over before the last patch stay gaps (Patch::is_gap). Failures are computed
/// for all of them again. `places` are as for route() and include the kept jumpers. Bounds are those of the whole
/// graph; more controllers may be needed. Errors: as route(), and std::out_of_range for a kept module that the graph
/// lacks. Cost: twice that of route().
[[nodiscard]] RoutingResult route_around(const ModuleGraph& graph, const std::vector<Jumper>& places,
                                         const KeptWiring& kept, const RoutingOptions& options = {},
                                         const ProgressSink& progress = {});

}  // namespace triskin::routing
