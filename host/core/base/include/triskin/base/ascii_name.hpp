// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin {

/// A name for formats that take letters, digits, `_` and the characters of `also` only: topics, identifiers of
/// simulators, files. A space, `-`, `.` or `/` becomes `_`. Names in other scripts stay different: what they lose is
/// told apart by eight hexadecimal digits of FNV-1a over the text ("左腕" and "右腕"). `if_empty` stands for "".
[[nodiscard]] std::string ascii_name(std::string_view text, std::string_view also, std::string_view if_empty);

}  // namespace triskin
