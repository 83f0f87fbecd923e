// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/cli/command.hpp"
#include "triskin/connect/open_link.hpp"

namespace triskin::cli {

/// `live --protocol icub`: the skin boards on a link, whoever made them; without a design there is no map to places.
/// Seconds ≤ 0: until Ctrl-C.
int live_icub(const device::LinkOptions& link, const design::Design* design, double seconds, Output& output);

}  // namespace triskin::cli
