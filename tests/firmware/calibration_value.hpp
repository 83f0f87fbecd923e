// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "triskin/layout/patch_image.hpp"
#include "triskin/wire/calibration.hpp"

namespace triskin::test {

/// Makes a calibration of every module of a table; the revision is part of all of its numbers.
inline wire::Calibration calibration_of(const layout::PatchImage& table, std::uint16_t revision) {
  wire::Calibration c{.exponent = 7, .revision = revision, .design_id = table.design_id, .made_unix_s = revision};
  for (const layout::ModuleRow& m : table.rows()) {
    wire::PlaceSensitivity& p = c.places[c.count++];
    p.place = static_cast<std::uint8_t>(m.line * layout::kAddressesPerLine + m.address);
    p.sensitivity.fill(static_cast<std::uint16_t>(19'200 + revision));
    p.error = p.residual_pa = revision;
  }
  return c;
}

inline std::vector<std::uint8_t> bytes_of(const wire::Calibration& calibration) {
  std::vector<std::uint8_t> bytes(wire::Calibration::kMaxBytes);
  ByteWriter w(bytes);
  calibration.encode(w);
  bytes.resize(w.size());
  return bytes;
}

}  // namespace triskin::test
