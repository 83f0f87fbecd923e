// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "triskin/session/clock_filter.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::device {

/// A sample of one module as it came over the wire, with the module that it belongs to in the design.
struct ModuleSample {
  int module = 0;                  ///< id in the design; in the frame it is a row of the controller's table
  std::uint64_t link_time_us = 0;  ///< clock of the link when the frame came
  wire::TaxelFrame sample;
  int cover = 0;       ///< index among the designs of the stream
  LinkTime sampled{};  ///< time at which the controller took it (ClockFilter)
  int adopter = -1;    ///< patch whose controller read it in place of the module's own; −1: its own did
};

}  // namespace triskin::device
