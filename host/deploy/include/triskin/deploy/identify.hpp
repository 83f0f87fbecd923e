// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/deploy/board_shape.hpp"
#include "triskin/design/design.hpp"
#include "triskin/link/touch_actuator.hpp"
#include "triskin/session/bus.hpp"

namespace triskin::device {

/// Design id of the table that a controller without one gets for identify(), so that it samples: such a controller
/// counts as fresh.
// These are the letters "IDENTIFY" in the table.
inline constexpr std::uint64_t kIdentifyDesign = 0x59464954'4E454449ULL;

struct IdentifyOptions {
  int patch = -1;         ///< It asks for this patch alone; −1 asks for all that shapes do not settle.
  double limit_s = 60.0;  ///< A touch of each patch is waited for so long, in time of the link.
  /// Presses the patches that are asked for; null: touches come by themselves.
  TouchActuator* actuator = nullptr;
  /// Called when patch `patch` is to be touched now.
  std::function<void(int patch)> ask;
  /// Called with a sentence when a touch cannot be used, and when a controller is left out.
  std::function<void(const std::string&)> say;
};

/// Controller of a patch.
struct IdentifiedBoard {
  int patch = 0;
  std::string serial;  ///< It is the unique id, or empty when nothing was found.
  FoundBy by = FoundBy::kNothing;
};

/// Finds out which controller serves which patch, and leaves it to the caller to write that down: by shape where that
/// settles it; else the person is asked to press any module of the patch, and the controller that feels it is the one.
/// The last controller for the last patch is not asked for. Controllers that share a node address get their own;
/// those without a table get one for what answers at their lines (kIdentifyDesign): without one a controller does not
/// sample. Tables that are there stay. Controllers that hold a table and share their address are left out, and said so.
/// The result has each asked patch once, ascending; `found` is called with each as soon as it is found. Takes 1.5 s,
/// and what the person takes. Throws DeviceError when nobody answers, InputError for a patch that the design lacks,
/// Cancelled.
std::vector<IdentifiedBoard> identify(Bus& bus, const design::Design& design, const IdentifyOptions& options,
                                      const std::function<void(const IdentifiedBoard&)>& found = {});

}  // namespace triskin::device
