// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/deploy/board_shape.hpp"
#include "triskin/design/design.hpp"
#include "triskin/link/touch_actuator.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/patch_table.hpp"
#include "triskin/session/scheduler.hpp"

namespace triskin::device {

struct FlashOptions {
  bool dry_run = false;  ///< It says what would change and writes nothing.
  bool force = false;    ///< It writes tables that are equal, too.
  RouteChoice route;     ///< The patch of this failure gets the tree that the design prepared for it.
  /// The electrodes hang on the converters' positive input (docs/silicon.md); the controllers turn the results round.
  bool positive_input = false;
  /// Conversations at once on one wire: while one board erases its page, others get their bytes. With 1 an analyser on
  /// a CAN bus shows whole transfers.
  int per_wire = kTasksPerWire;
  /// Patch and unique id (24 upper-case hexadecimal digits) of the controller that is to serve it, whatever it holds.
  struct Assignment {
    int patch = 0;
    std::string serial;
  };
  std::vector<Assignment> assign;
  /// Controller of another design on the same bus, as a robot file names it.
  struct Neighbour {
    std::uint8_t node = 0;        ///< It is its node address.
    std::uint64_t design_id = 0;  ///< Its table is of this design.
    std::string serial;           ///< It is the unique id as in Assignment, or empty when unknown.
    /// Design of the neighbour, if available: it distinguishes fresh controllers of the neighbour from ours.
    const design::Design* design = nullptr;
    int patch = 0;
  };
  /// They keep their tables, and their addresses are given to nobody else.
  std::vector<Neighbour> neighbours;
  int patch = -1;  ///< It flashes this patch alone; −1 flashes all.
  /// Controllers without a table are told apart by the shapes of their patches, before anything is written; those with
  /// equal shapes are refused. False: they get the patches in the order of their unique ids.
  bool recognise = false;
  /// Together with `recognise`: presses patches whose controllers have equal shapes, which tells them apart; null:
  /// nobody does. It counts the modules of the design.
  TouchActuator* actuator = nullptr;
  bool take_over = false;                       ///< Controllers that hold a table of another design may be taken.
  double wait_s = 0.0;                          ///< An unplugged cable is waited for so long before this is an error.
  std::function<void(const std::string&)> say;  ///< It gets a sentence when flashing waits and when it continues.
};

struct FlashResult {
  struct Patch {
    int patch = 0;
    std::string serial;  ///< It is the controller's unique id.
    /// A dry run has kNothing, because which controller it will be shows only when flashing.
    FoundBy by = FoundBy::kNothing;
    int old_address = 0;  ///< It had this node address before.
    int address = 0;      ///< It is the node address of the patch.
    bool new_address = false;
    bool equal = false;    ///< The table was there already.
    bool written = false;  ///< The table was written, read back and compared.
    std::size_t bytes = 0;
    std::string why;  ///< It says why it has not got its table, and is empty if it has, or in a dry run.
  };
  std::vector<Patch> patches;  ///< Those with a controller come first, then those without, each in their order.
  std::size_t bytes = 0;       ///< All controllers together got so many.
  int skipped = 0;
  double link_s = 0.0;  ///< It is the time of the link for all covers of the pass, and virtual in the simulation.
};

/// One cover of those that flash_together() serves.
struct FlashPart {
  Bus* bus = nullptr;  ///< Each part has a bus of its own, all over one link.
  const design::Design* design = nullptr;
  FlashOptions options;  ///< Those of the first part hold for per_wire, wait_s and say.
  ProgressSink progress;
};

/// Puts the tables of a design into the controllers on the bus: finds them by unique id, gives each patch a controller
/// and its address (design::node_address_of), skips equal tables, writes the others, reads them back and compares every
/// byte. Controllers that `options.assign` names get that patch, those that hold a table of this design keep theirs,
/// also when its address has changed; others without a table are told apart as `options.recognise` says. A controller
/// that holds a table of another design is written only when it is named, or with `options.take_over`. The
/// conversations with up to `options.per_wire` controllers of a wire, and those on different wires, go on side by side;
/// when one fails, the others are served all the same. Throws InputError for a name that cannot be; DeviceError naming
/// every patch without its table and why: its controller does not answer or refuses, a table reads back differently, or
/// it has no controller (then only controllers that are named or hold their table are served, and where there are none
/// nothing is written); Cancelled when the process was asked to end. Both say what was done before; each controller
/// then has its old table or its new one, whole, and running it again continues. Progress has a part for each patch.
FlashResult flash(Bus& bus, const design::Design& design, const FlashOptions& options = {},
                  const ProgressSink& progress = {});

/// flash() for several covers of one bus in one pass: first it is decided for one after the other which controllers are
/// theirs, then all tables are written side by side. `results`: by part, with what is done also when this throws. A
/// cover whose controllers cannot be told leaves those before it their tables and ends the pass. Throws as flash().
void flash_together(std::span<const FlashPart> parts, std::vector<FlashResult>& results);

}  // namespace triskin::device
