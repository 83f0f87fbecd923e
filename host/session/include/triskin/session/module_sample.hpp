// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "triskin/session/clock_filter.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::device {

/// A received sample names the module of the design that it belongs to.
struct ModuleSample {
  int module = 0;  ///< The module is an id in the design, whereas the frame has a row of the controller's table.
  std::uint64_t link_time_us = 0;  ///< The frame arrived at this time of the link's clock.
  wire::TaxelFrame sample;
  int cover = 0;       ///< The number is an index among the designs of the stream.
  LinkTime sampled{};  ///< ClockFilter computes the time at which the controller took the sample.
  int adopter = -1;    ///< The controller of this other patch read the module; −1 means that its own controller did.
};

}  // namespace triskin::device
