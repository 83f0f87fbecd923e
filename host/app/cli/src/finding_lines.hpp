// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "triskin/diagnose/verify.hpp"

namespace triskin::cli {

[[nodiscard]] nlohmann::json finding_json(const design::Design& design, const diagnose::Finding& finding);
/// Formats a finding for a person: the problem, its place, the remedy, and the steps.
[[nodiscard]] std::vector<std::string> finding_lines(const diagnose::Finding& finding,
                                                     const std::vector<std::string>& steps);

}  // namespace triskin::cli
