// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>

#include <cstdint>
#include <string>

namespace triskin::device {

/// "MAJOR.MINOR.PATCH" of a version as it is on the wire: 8 bits each, below them 8 that do not count here
/// (wire::Hello::firmware_version).
[[nodiscard]] inline std::string firmware_version_text(std::uint32_t version) {
  return fmt::format("{}.{}.{}", version >> 24 & 0xFF, version >> 16 & 0xFF, version >> 8 & 0xFF);
}

}  // namespace triskin::device
