// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "triskin/base/format_index.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/session/clock_filter.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::session {

/// A received sample names the module of the design that it belongs to.
struct ModuleSample {
  layout::ModuleId module;         ///< The frame in `sample` has a row of the controller's table instead.
  std::uint64_t link_time_us = 0;  ///< The frame arrived at this time of the link's clock.
  wire::TaxelFrame sample;
  layout::CoverIndex cover{};
  LinkTime sampled{};  ///< ClockFilter computes the time at which the controller took the sample.
  /// The controller of this other patch read the module; −1 means that its own controller did.
  layout::PatchIndex adopter = layout::PatchIndex::none();
};

}  // namespace triskin::session
