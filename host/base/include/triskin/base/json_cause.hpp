// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin {

/// Explains an exception of the JSON library to somebody who edits files: where the place is known, the message begins
/// with "line 1, column 5: …". It quotes neither the library's words nor bytes of the file.
[[nodiscard]] std::string json_cause(std::string_view what);

}  // namespace triskin
