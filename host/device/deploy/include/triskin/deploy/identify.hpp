// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/base/progress.hpp"
#include "triskin/deploy/board_shape.hpp"
#include "triskin/design/design.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/link/touch_actuator.hpp"
#include "triskin/session/bus.hpp"

namespace triskin::deploy {

struct IdentifyOptions {
  /// Only this patch is identified; −1 means all that the shapes do not settle.
  layout::PatchIndex patch = layout::PatchIndex::none();
  double limit_s = 60.0;  ///< Waiting for the touch of a patch ends after this time of the link.
  /// Presses the requested patches; null means that a person touches them.
  link::TouchActuator* actuator = nullptr;
  /// Called when patch `patch` must be touched now.
  std::function<void(layout::PatchIndex patch)> ask;
  /// Called with a sentence when a touch cannot be used, and when a controller is left out.
  std::function<void(const std::string&)> say;
};

struct IdentifiedBoard {
  layout::PatchIndex patch;
  std::string serial;  ///< The serial number is the unique id, or empty when no controller was found.
  FoundBy by = FoundBy::kNothing;
};

/// Finds out which controller serves which patch, without recording the result anywhere. If shapes do not settle it,
/// the person is asked to press any module of the patch, and the controller that feels it serves the patch. The last
/// controller for the last patch needs no touch. Controllers that share a node address get separate ones. Those without
/// a table get one for the chips that answer on their lines (kIdentifyDesign), because a controller without a table
/// does not sample; existing tables stay. Controllers with a table that share their address are left out and reported.
/// The result has each requested patch once, ascending; `found` is called with each as soon as it is found. Takes 1.5 s
/// plus the time of the person. Throws DeviceError when no controller answers, InputError for a patch that the design
/// lacks, Cancelled.
std::vector<IdentifiedBoard> identify(session::Bus& bus, const design::Design& design, const IdentifyOptions& options,
                                      const std::function<void(const IdentifiedBoard&)>& found = {});

}  // namespace triskin::deploy
