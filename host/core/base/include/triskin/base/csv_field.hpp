// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin {

/// Writes `text` as one field of a CSV line (RFC 4180): in quotes if it has a comma, a quote, a line break or a space
/// at an end. Text that a spreadsheet would take for a formula (a leading =, +, -, @ or tabulator) gets an apostrophe
/// in front, as spreadsheets write text. Cost: linear. Threads: any.
[[nodiscard]] std::string csv_field(std::string_view text);

}  // namespace triskin
