// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "triskin/core/bytes.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/wire/checked_enum.hpp"
#include "triskin/wire/identifiers.hpp"

/// A calibration says how many counts of each taxel correspond to one kPa; the controller stores it with its table
/// (FD0D). See docs/calibration.md.
namespace triskin::wire {

/// During the calibration, pressure was applied in one of these ways.
enum class CalibrationMethod : std::uint8_t { kSteps = 0, kWeights = 1, kRamp = 2 };
/// Converts a number from the wire. Error: kOutOfRange.
[[nodiscard]] constexpr Result<CalibrationMethod> to_calibration_method(std::uint8_t number) {
  return checked_enum(number, CalibrationMethod::kRamp);
}

/// Each place has the calibration of the taxels of its module.
struct PlaceSensitivity {
  std::uint8_t place = 0;  ///< The place is kAddressesPerLine · line + address.
  /// 1 kPa lowers a taxel by this many units of 2^-exponent counts; 0 means not calibrated.
  std::array<std::uint16_t, layout::kTaxelsPerModule> sensitivity{};
  /// The value bounds the relative error of the module's worst taxel in units of 0.01 %; 65535 means at least that.
  std::uint16_t error = 0;
  /// No calibration point of the module is farther from its fitted line than this; 65535 means at least that.
  std::uint16_t residual_pa = 0;
  bool operator==(const PlaceSensitivity&) const = default;
};

/// Identifier FD0D carries the calibration of a controller's modules. Writing a value without rows deletes the stored
/// calibration.
struct Calibration {
  static constexpr std::uint16_t kId = did::kCalibration;
  static constexpr std::uint8_t kVersion = 1;  ///< Readers refuse a value of another version.
  static constexpr std::uint8_t kMaxExponent = 30;
  static constexpr std::size_t kHeadBytes = 27, kRowBytes = 5 + 2 * layout::kTaxelsPerModule;
  static constexpr std::size_t kMinBytes = kHeadBytes, kMaxBytes = kHeadBytes + kRowBytes * layout::kMaxModules;
  std::uint8_t exponent = 0;    ///< All sensitivities have this exponent in common, 0 … kMaxExponent.
  std::uint16_t revision = 1;   ///< Each calibration of the controller adds 1, starting at 1.
  std::uint64_t design_id = 0;  ///< The controller had the table of this design during the calibration.
  std::uint16_t patch = 0;      ///< Patches are numbered from 0 within that design.
  std::uint32_t made_unix_s = 0;
  CalibrationMethod method = CalibrationMethod::kSteps;
  std::uint32_t max_pa = 0;      ///< The calibration is valid up to this pressure, the largest that was applied.
  std::uint32_t taxel_area = 1;  ///< The area of skin per taxel is given in 10⁻⁴ mm² and is at least 1.
  std::uint8_t count = 0;        ///< Valid values are 0 to kMaxModules.
  std::array<PlaceSensitivity, layout::kMaxModules> places{};

  /// Returns the modules in the order in which they were written.
  [[nodiscard]] constexpr std::span<const PlaceSensitivity> rows() const { return std::span(places).first(count); }
  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    out.u8(kVersion);
    out.u8(exponent);
    out.le16(revision);
    out.le64(design_id);
    out.le16(patch);
    out.le32(made_unix_s);
    out.u8(wire_number(method));
    out.le32(max_pa);
    out.le32(taxel_area);
    for (const PlaceSensitivity& p : rows()) {
      out.u8(p.place);
      for (const std::uint16_t s : p.sensitivity) out.le16(s);
      out.le16(p.error);
      out.le16(p.residual_pa);
    }
  }
  /// Decodes the wire format. Errors: kBadLength (a partial row, too many rows), kBadVersion, kOutOfRange (no such
  /// exponent, revision, method, area or place), kDuplicate (a place twice).
  [[nodiscard]] static constexpr Result<Calibration> decode(Bytes bytes) {
    if (bytes.size() < kMinBytes || bytes.size() > kMaxBytes || (bytes.size() - kHeadBytes) % kRowBytes != 0)
      return std::unexpected(Status::kBadLength);
    ByteReader r(bytes);
    if (r.u8() != kVersion) return std::unexpected(Status::kBadVersion);
    Calibration c;
    c.exponent = r.u8();
    c.revision = r.le16();
    c.design_id = r.le64();
    c.patch = r.le16();
    c.made_unix_s = r.le32();
    const auto method = to_calibration_method(r.u8());
    c.max_pa = r.le32();
    c.taxel_area = r.le32();
    if (!method || c.exponent > kMaxExponent || c.revision == 0 || c.taxel_area == 0)
      return std::unexpected(Status::kOutOfRange);
    c.method = *method;
    std::uint32_t taken = 0;
    while (!r.rest().empty()) {
      const PlaceSensitivity& p = c.places[c.count++] = decode_row(r);
      if (p.place >= layout::kMaxModules) return std::unexpected(Status::kOutOfRange);
      if ((taken >> p.place & 1U) != 0) return std::unexpected(Status::kDuplicate);
      taken |= 1U << p.place;
    }
    return c;
  }
  bool operator==(const Calibration&) const = default;

 private:
  [[nodiscard]] static constexpr PlaceSensitivity decode_row(ByteReader& r) {
    PlaceSensitivity p;
    p.place = r.u8();
    for (std::uint16_t& s : p.sensitivity) s = r.le16();
    p.error = r.le16();
    p.residual_pa = r.le16();
    return p;
  }
};
static_assert(kLengthsAsInTable<Calibration>);

}  // namespace triskin::wire
