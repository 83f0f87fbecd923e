// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/host/progress.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/patch_table.hpp"

namespace triskin::device {

struct FlashOptions {
  bool dry_run = false;  ///< say what would change, write nothing
  bool force = false;    ///< write equal tables too
  RouteChoice route;     ///< the patch of this failure gets the tree that the design prepared for it
  /// The electrodes hang on the converters' positive input (docs/silicon.md); the controllers turn the results round.
  bool positive_input = false;
  int per_wire = 1;     ///< controllers at once on one wire; one, so that an analyser on a CAN bus can follow
  double wait_s = 0.0;  ///< how long an unplugged cable is waited for before this is an error
  std::function<void(const std::string&)> say;  ///< called with a sentence when flashing waits and when it continues
};

struct FlashResult {
  struct Patch {
    int patch = 0;
    std::string serial;   ///< unique id
    int old_address = 0;  ///< node address before
    bool new_address = false;
    bool equal = false;    ///< the table was there already
    bool written = false;  ///< written, read back and compared
    std::size_t bytes = 0;
  };
  std::vector<Patch> patches;
  std::size_t bytes = 0;  ///< written, all controllers
  int skipped = 0;
  double link_s = 0.0;  ///< time of the link, virtual in the simulation
};

/// Puts the tables of a design into the controllers on the bus: finds them by unique id, gives each patch a controller
/// and an address of its own, skips equal tables, writes the others, reads them back and compares every byte.
/// Controllers that hold a table of this design keep their patch; others are taken in the order of their unique ids.
/// Throws DeviceError when there are fewer controllers than patches (nothing is written then), when one does not answer
/// or refuses, or when a table read back differs; Cancelled when the process was asked to end. Both say what was done
/// before; each controller then has its old table or its new one, whole, and running it again continues. Controllers on
/// different wires are served side by side; when one fails, the others are served all the same. Progress has a part for
/// each patch.
FlashResult flash(Bus& bus, const design::Design& design, const FlashOptions& options = {},
                  const ProgressSink& progress = {});

}  // namespace triskin::device
