// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "triskin/layout/module.hpp"

namespace triskin::design {

/// Counts of the taxels of a skin that nobody touches, by module of the design; empty: they were never taken.
using RestValues = std::vector<std::array<double, layout::kTaxelsPerModule>>;

/// The file that keeps them: JSON with the format `triskin-rest`, version 1.
[[nodiscard]] std::string rest_text(const RestValues& rest);
/// Reads such a file. `name` is for messages, `modules` is how many the design has. Throws InputError with the place
/// when it is damaged or of another number of modules.
[[nodiscard]] RestValues parse_rest(const std::string& text, const std::string& name, std::size_t modules);

}  // namespace triskin::design
