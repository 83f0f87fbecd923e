// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/diagnose/verify.hpp"

namespace triskin::device {

/// What a verification found, one finding after the other: what, where on the cover, what to do, and the steps of the
/// repair with `arguments` as repair_steps() takes them. UTF-8, ends with a line that counts. Throws as repair_steps().
/// Cost: linear, and repair_steps() for each finding.
[[nodiscard]] std::string report_text(const design::Design& design, const VerifyResult& result,
                                      const std::string& arguments = "DESIGN");
/// The same as a page to print (HTML without references to other files): a drawing of the lattice on which the modules
/// of the findings are marked with the finding's number, and a table. Cost: linear.
[[nodiscard]] std::string report_html(const design::Design& design, const VerifyResult& result,
                                      const std::string& arguments = "DESIGN");

}  // namespace triskin::device
