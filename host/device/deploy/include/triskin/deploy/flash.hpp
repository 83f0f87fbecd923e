// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/base/progress.hpp"
#include "triskin/deploy/board_shape.hpp"
#include "triskin/design/design.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/link/touch_actuator.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/patch_table.hpp"
#include "triskin/session/scheduler.hpp"

namespace triskin::deploy {

struct FlashOptions {
  bool dry_run = false;        ///< Nothing is written; the result says what would change.
  bool force = false;          ///< Tables are written even if they are equal.
  session::RouteChoice route;  ///< The patch of this failure gets the tree that the design prepared for it.
  /// The electrodes are on the converters' positive input (docs/silicon.md), so the controllers invert the results.
  bool positive_input = false;
  /// This many conversations run at once on one wire: while one board erases its page, others receive their bytes. With
  /// 1, an analyser on a CAN bus shows whole transfers.
  int per_wire = session::kTasksPerWire;
  /// The controller with this unique id (24 upper-case hexadecimal digits) must serve the patch, whatever it contains.
  struct Assignment {
    layout::PatchIndex patch;
    std::string serial;
  };
  std::vector<Assignment> assign;
  /// A robot file can name controllers of another design on the same bus.
  struct Neighbour {
    layout::NodeAddress node;
    std::uint64_t design_id = 0;  ///< The controller's table is of this design.
    std::string serial;           ///< The serial number is the unique id as in Assignment, or empty when unknown.
    /// The design of the neighbour, if available, helps to tell its new controllers from ours.
    const design::Design* design = nullptr;
    layout::PatchIndex patch;
  };
  /// These controllers keep their tables and their addresses.
  std::vector<Neighbour> neighbours;
  layout::PatchIndex patch = layout::PatchIndex::none();  ///< Only this patch is flashed; −1 means all.
  /// Before anything is written, controllers without a table are distinguished by the shapes of their patches, and
  /// those with equal shapes are refused. False: they get the patches in the order of their unique ids.
  bool recognise = false;
  /// Together with `recognise`, the actuator presses patches whose controllers have equal shapes, which distinguishes
  /// them; null disables this. It uses the module ids of the design.
  link::TouchActuator* actuator = nullptr;
  bool take_over = false;  ///< Controllers with a table of another design may be used.
  double wait_s = 0.0;     ///< After a cable is unplugged, flashing waits this long before it fails.
  /// The function gets a sentence when flashing waits and when it continues.
  std::function<void(const std::string&)> say;
};

struct FlashResult {
  struct Patch {
    layout::PatchIndex patch;
    std::string serial;  ///< The serial number is the controller's unique id.
    /// In a dry run this is kNothing, because only flashing shows which controller it will be.
    FoundBy by = FoundBy::kNothing;
    layout::NodeAddress old_address;  ///< The controller had this node address before.
    layout::NodeAddress address;      ///< The patch has this node address.
    bool new_address = false;
    bool equal = false;    ///< The controller already had the table.
    bool written = false;  ///< The table was written, read back and compared.
    std::size_t bytes = 0;
    std::string why;  ///< The text says why the table was not written; it is empty if it was, or in a dry run.
  };
  std::vector<Patch> patches;  ///< Patches with a controller are listed first, then those without, each in their order.
  std::size_t bytes = 0;       ///< All controllers together received this many.
  int skipped = 0;
  /// The time includes all covers of the pass, by the clock of the link, which is virtual in the simulation.
  double link_s = 0.0;
};

/// flash_together() serves several covers, each given as a part.
struct FlashPart {
  session::Bus* bus = nullptr;  ///< Each part has its own bus object, all over one link.
  const design::Design* design = nullptr;
  FlashOptions options;  ///< The options per_wire, wait_s and say are taken from the first part.
  ProgressSink progress;
};

/// Writes the tables of a design into the controllers on the bus: finds them by unique id, gives each patch a
/// controller and its address (design::node_address_of), skips equal tables, writes the others, reads them back and
/// compares every byte. Controllers named in `options.assign` get that patch. Those with a table of this design keep
/// theirs, even if the patch's address has changed. Others without a table are distinguished as `options.recognise`
/// says. A controller with a table of another design is written only when it is named, or with `options.take_over`. Up
/// to `options.per_wire` controllers of a wire are served at the same time, and different wires in parallel; when one
/// controller fails, the others are still served. Throws InputError for an invalid name; DeviceError naming every patch
/// without its table and the reason: its controller does not answer or refuses, a table reads back differently, or it
/// has no controller (then only controllers that are named or have their table are served, and if there are none,
/// nothing is written); Cancelled when the process was asked to end. Both messages say what was done before. Each
/// controller then has either its complete old table or its complete new one, and a second run continues. Progress has
/// a part for each patch.
FlashResult flash(session::Bus& bus, const design::Design& design, const FlashOptions& options = {},
                  const ProgressSink& progress = {});

/// Does the work of flash() for several covers of one bus in one pass: first it decides for one cover after the other
/// which controllers are theirs, then it writes all tables in parallel. `results` is indexed by part and says what was
/// done, even when this throws. If the controllers of a cover cannot be determined, the covers before it still get
/// their tables, and the pass ends. Throws as flash().
void flash_together(std::span<const FlashPart> parts, std::vector<FlashResult>& results);

}  // namespace triskin::deploy
