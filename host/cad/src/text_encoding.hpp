// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin::cad {

/// How a STEP file writes bytes above 127, which its standard forbids and programs write all the same.
enum class RawEncoding { kUtf8, kGbk, kLatin1 };
/// What the bytes above 127 of a file most likely are. GBK: they come in pairs. Cost: linear.
[[nodiscard]] RawEncoding guess_encoding(std::string_view bytes);

/// Text of a STEP string (what stands between its quotes, '' still doubled) as UTF-8: \X\, \X2\, \X4\, \S\, \P\,
/// \N\ and
/// \\ resolved, raw bytes by `encoding`, control characters dropped. Damaged escapes stay as they are.
[[nodiscard]] std::string decode_step_string(std::string_view raw, RawEncoding encoding);
/// The same text as a STEP string in ASCII, without the quotes.
[[nodiscard]] std::string encode_step_string(std::string_view utf8);

}  // namespace triskin::cad
