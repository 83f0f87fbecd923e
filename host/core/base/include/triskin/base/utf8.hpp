// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

namespace triskin {

/// Appends a Unicode character as UTF-8. A value that is no character (half of a pair of UTF-16, or above 0x10FFFF)
/// becomes U+FFFD. Constant cost.
void append_utf8(std::string& out, char32_t c);

}  // namespace triskin
