// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace triskin {

/// Text in UTF-16 (with a byte order mark, or with a zero in every other byte of its beginning) becomes UTF-8; all
/// other bytes stay. Halves of surrogate pairs become U+FFFD. Cost: linear.
[[nodiscard]] std::string without_utf16(std::string bytes);

/// A text as readers of lines and of JSON expect it, from whichever editor it comes: UTF-16 becomes UTF-8, a byte order
/// mark is left out, and the line ends CR and CRLF become LF. Cost: linear; a text that has none of these stays.
[[nodiscard]] std::string plain_text(std::string bytes);

/// plain_text() of a whole file; "-" is standard input. Throws InputError naming the file when it cannot be read.
[[nodiscard]] std::string read_text(const std::filesystem::path& path);

/// For texts whose lines end with a number and that have no end mark, as CSV: what to say about one whose last line has
/// no end, "NAME: ends without a line end: …". Empty for one that ends with a line end.
[[nodiscard]] std::string note_of_open_line(std::string_view text, std::string_view name);

}  // namespace triskin
