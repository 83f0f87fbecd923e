// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin {

/// Encodes bytes as text of A-Z, a-z, 0–9, + and /, four characters for three bytes, padded with = (RFC 4648, section
/// 4).
[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace triskin
