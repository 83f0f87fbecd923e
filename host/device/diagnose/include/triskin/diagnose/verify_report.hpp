// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/diagnose/verify.hpp"

namespace triskin::diagnose {

/// Formats the findings of a verification one after the other: the problem, its place on the cover, the remedy, and the
/// repair steps with `arguments` as for repair_steps(). UTF-8; the last line has the counts. Throws as repair_steps().
/// Cost: linear, and repair_steps() for each finding.
[[nodiscard]] std::string report_text(const design::Design& design, const VerifyResult& result,
                                      const std::string& arguments = "DESIGN");
/// Formats the same as a page to print (HTML without references to other files): a drawing of the lattice in which the
/// modules of the findings are marked with the finding's number, and a table. Throws as repair_steps(). Cost:
/// linear.
[[nodiscard]] std::string report_html(const design::Design& design, const VerifyResult& result,
                                      const std::string& arguments = "DESIGN");

}  // namespace triskin::diagnose
