// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin::cad {

/// The standard of STEP forbids bytes above 127, but programs write them in these encodings.
enum class RawEncoding { kUtf8, kGbk, kLatin1 };
/// Guesses the encoding of the bytes above 127. Bytes of GBK come in pairs. Cost: linear.
[[nodiscard]] RawEncoding guess_encoding(std::string_view bytes);

/// Returns the text of a STEP string (between its quotes, '' still doubled) as UTF-8, with \X\, \X2\, \X4\, \S\, \P\,
/// \N\ and \\ resolved, raw bytes by `encoding`, control characters dropped. Damaged escapes stay as they are.
[[nodiscard]] std::string decode_step_string(std::string_view raw, RawEncoding encoding);
/// Returns the same text as a STEP string in ASCII, without the quotes.
[[nodiscard]] std::string encode_step_string(std::string_view utf8);

}  // namespace triskin::cad
