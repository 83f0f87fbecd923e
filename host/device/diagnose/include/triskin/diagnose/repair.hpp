// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/diagnose/verify.hpp"

namespace triskin::diagnose {

/// Returns the steps that repair a finding, in order: what to keep, which module it is and where it lies, which of its
/// joints carry the lines and which are cut, and what to strap, flash, tare and verify. `arguments` follows `triskin
/// flash` and `triskin verify` ("forearm.json --link can:can0"). Never empty. Throws InputError for a design that does
/// not fit into tables. Cost: image_of for one patch.
[[nodiscard]] std::vector<std::string> repair_steps(const design::Design& design, const Finding& finding,
                                                    const std::string& arguments);

}  // namespace triskin::diagnose
