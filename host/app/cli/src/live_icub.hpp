// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "command.hpp"
#include "triskin/connect/open_link.hpp"

namespace triskin::cli {

/// Implements `live --protocol icub`: shows the skin boards on a link, whoever made them; without a design it cannot
/// show positions. Seconds ≤ 0 means until Ctrl-C.
int live_icub(const connect::LinkOptions& link, const design::Design* design, double seconds, Output& output);

}  // namespace triskin::cli
