// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "triskin/diagnose/verify.hpp"

namespace triskin::cli {

/// Keys of a finding in --json.
[[nodiscard]] nlohmann::json finding_json(const device::Finding& finding);
/// What a person reads: what was found, where it lies, what to do, and the steps.
[[nodiscard]] std::vector<std::string> finding_lines(const device::Finding& finding,
                                                     const std::vector<std::string>& steps);

}  // namespace triskin::cli
