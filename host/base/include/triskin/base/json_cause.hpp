// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin {

/// Message of an exception of the JSON library in the words of somebody who edits files: where it knows a place,
/// "line 1, column 5: …", then what is wrong there. Words of the library and bytes of the file stay out of it.
[[nodiscard]] std::string json_cause(std::string_view what);

}  // namespace triskin
