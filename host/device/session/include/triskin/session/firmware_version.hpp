// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>

#include <cstdint>
#include <string>

namespace triskin::session {

/// Formats a version as "MAJOR.MINOR.PATCH". On the wire each number has 8 bits; the lowest 8 bits are ignored
/// (wire::Hello::firmware_version).
[[nodiscard]] inline std::string firmware_version_text(std::uint32_t version) {
  return fmt::format("{}.{}.{}", version >> 24 & 0xFF, version >> 16 & 0xFF, version >> 8 & 0xFF);
}

}  // namespace triskin::session
