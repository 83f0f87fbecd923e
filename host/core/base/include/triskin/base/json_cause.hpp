// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin {

/// Explains an exception of the JSON library to somebody who edits files: where the place is known, the message begins
/// with "line 1, column 5: …". It quotes neither the library's words nor bytes of the file.
[[nodiscard]] std::string json_cause(std::string_view what);

/// Returns true if a text can be a JSON object: its first byte that is no blank is a brace. An empty text cannot.
[[nodiscard]] bool begins_as_json_object(std::string_view text);

}  // namespace triskin
