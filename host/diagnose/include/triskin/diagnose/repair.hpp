// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/diagnose/verify.hpp"

namespace triskin::device {

/// The steps that mend what a finding names, in order: what to keep, which module and where it lies, which of its
/// joints carry the lines and which are cut, what to strap, flash, tare, verify. `arguments`: what stands behind
/// `triskin flash` and `triskin verify` ("forearm.json --link can:can0"). Never empty. Throws InputError for a design
/// that does not fit into tables. Cost: image_of for one patch.
[[nodiscard]] std::vector<std::string> repair_steps(const design::Design& design, const Finding& finding,
                                                    const std::string& arguments);

}  // namespace triskin::device
