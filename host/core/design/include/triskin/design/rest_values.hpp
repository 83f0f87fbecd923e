// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "triskin/layout/module.hpp"

namespace triskin::design {

/// Rest values are the counts of the untouched taxels of a skin, indexed by module of the design; empty means that they
/// were never taken.
using RestValues = std::vector<std::array<double, layout::kTaxelsPerModule>>;

/// What is known of the rest before the first sample.
struct KnownRest {
  RestValues kept{};     ///< of a tare or a calibration
  RestValues settled{};  ///< what the controllers said (session::settled_rest()); NaN: not known; empty: not asked
};

/// Formats rest values as JSON of format `triskin-rest`, version 1.
[[nodiscard]] std::string rest_text(const RestValues& rest);
/// Parses such a file. `name` appears in messages, `modules` is the number in the design. Throws InputError with the
/// place when the file is damaged or has another number of modules.
[[nodiscard]] RestValues parse_rest(const std::string& text, const std::string& name, std::size_t modules);

/// Formats what controllers say of the rest in the same form, with null for NaN, which means not known; returns an
/// empty text if nothing is known.
[[nodiscard]] std::string settled_text(const RestValues& settled);
/// Parses the text of settled_text(), otherwise as parse_rest().
[[nodiscard]] RestValues parse_settled(const std::string& text, const std::string& name, std::size_t modules);

}  // namespace triskin::design
