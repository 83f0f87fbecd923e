// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace triskin {

/// Converts UTF-16 text (with a byte order mark, or with a zero in every other byte of its beginning) to UTF-8 and
/// leaves all other bytes as they are. Unpaired surrogates become U+FFFD. Cost: linear.
[[nodiscard]] std::string without_utf16(std::string bytes);

/// Normalises a text from any editor for the readers of lines and of JSON: UTF-16 becomes UTF-8, a byte order mark is
/// removed, and the line ends CR and CRLF become LF. Cost: linear; a text without any of these stays as it is.
[[nodiscard]] std::string plain_text(std::string bytes);

/// Reads a whole file through plain_text(); "-" is standard input. Throws InputError naming an unreadable file.
[[nodiscard]] std::string read_text(const std::filesystem::path& path);

/// Returns a note "NAME: ends without a line end: …" if the last line has no end, else an empty string. Formats such
/// as CSV have no end mark, so a last number that was cut short would look complete.
[[nodiscard]] std::string note_of_open_line(std::string_view text, std::string_view name);

}  // namespace triskin
