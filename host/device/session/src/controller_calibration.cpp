// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/controller_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>

#include "triskin/base/wall_clock.hpp"
#include "triskin/session/address_users.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::session {
namespace {

constexpr double kMax16 = 65535.0;
constexpr double kErrorStep_percent = 0.01, kPaPerKpa = 1000.0, kAreaStep_mm2 = 1e-4;

std::uint16_t rounded_up(double value, double step) {
  return static_cast<std::uint16_t>(std::clamp(std::ceil(value / step - 1e-9), 0.0, kMax16));
}
std::uint32_t in_steps(double value, double step) {
  return static_cast<std::uint32_t>(std::clamp(std::round(value / step), 0.0, 4294967295.0));
}

std::uint32_t unix_of(const std::string& made) {
  std::tm t{};
  if (std::sscanf(made.c_str(), "%4d-%2d-%2dT%2d:%2d:%2dZ", &t.tm_year, &t.tm_mon, &t.tm_mday, &t.tm_hour, &t.tm_min,
                  &t.tm_sec) != 6)
    return 0;
  t.tm_year -= 1900;
  --t.tm_mon;
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(timegm(&t), 0, 0xFFFFFFFF));
}

// Returns the finest unit, 2^-exponent counts/kPa, in which the greatest sensitivity fits into 16 bits.
std::uint8_t exponent_for(const design::BoardCalibration& board) {
  double greatest = 0.0;
  for (const auto& place : board.places) {
    for (const auto& t : place.taxels) greatest = std::max(greatest, t.counts_per_kpa);
  }
  std::uint8_t exponent = 0;
  while (exponent < wire::Calibration::kMaxExponent && std::ldexp(greatest, exponent + 1) <= kMax16) ++exponent;
  return exponent;
}

wire::PlaceSensitivity row_of(const design::PlaceCalibration& place, int exponent) {
  wire::PlaceSensitivity row;
  row.place = static_cast<std::uint8_t>(layout::kAddressesPerLine * place.line + place.address);
  for (std::size_t t = 0; t < row.sensitivity.size(); ++t) {
    const design::TaxelSensitivity& taxel = place.taxels[t];
    if (taxel.counts_per_kpa <= 0.0) continue;
    const double steps = std::round(std::ldexp(taxel.counts_per_kpa, exponent));
    // A value of 0 would mean that there is no calibration.
    row.sensitivity[t] = static_cast<std::uint16_t>(std::clamp(steps, 1.0, kMax16));
    row.error = std::max(row.error, rounded_up(taxel.error_percent, kErrorStep_percent));
    row.residual_pa = std::max(row.residual_pa, rounded_up(taxel.residual_kpa * kPaPerKpa, 1.0));
  }
  return row;
}

}  // namespace

wire::Calibration to_wire(const design::BoardCalibration& board) {
  wire::Calibration c;
  c.exponent = exponent_for(board);
  c.revision = static_cast<std::uint16_t>(std::clamp(board.revision, 1, 65535));
  c.design_id = board.design_id;
  c.patch = static_cast<std::uint16_t>(board.patch);
  c.made_unix_s = unix_of(board.made);
  c.method = board.method;
  c.max_pa = in_steps(board.max_kpa, 1.0 / kPaPerKpa);
  c.taxel_area = std::max(1U, in_steps(board.taxel_area_mm2, kAreaStep_mm2));
  for (const design::PlaceCalibration& place : board.places) {
    if (c.count < c.places.size()) c.places[c.count++] = row_of(place, c.exponent);
  }
  return c;
}

design::BoardCalibration from_wire(const wire::Calibration& kept, const std::string& serial) {
  design::BoardCalibration board;
  board.serial = serial;
  board.design_id = kept.design_id;
  board.patch = layout::PatchIndex{kept.patch};
  board.revision = kept.revision;
  board.made = utc_text(kept.made_unix_s);
  board.method = kept.method;
  board.max_kpa = kept.max_pa / kPaPerKpa;
  board.taxel_area_mm2 = kept.taxel_area * kAreaStep_mm2;
  for (const wire::PlaceSensitivity& row : kept.rows()) {
    design::PlaceCalibration& place = board.places.emplace_back();
    place.line = row.place / layout::kAddressesPerLine;
    place.address = row.place % layout::kAddressesPerLine;
    for (std::size_t t = 0; t < place.taxels.size(); ++t) {
      if (row.sensitivity[t] == 0) continue;
      place.taxels[t] = {std::ldexp(row.sensitivity[t], -kept.exponent), row.error * kErrorStep_percent,
                         row.residual_pa / kPaPerKpa};
    }
  }
  return board;
}

std::vector<design::BoardCalibration> kept_in_controllers(Bus& bus, const design::Design& design,
                                                          std::span<const wire::NodeClaim> claims) {
  const auto users = users_of_addresses(claims);
  std::vector<design::BoardCalibration> boards;
  for (const wire::NodeClaim& claim : claims) {
    if (design::patch_at(design, layout::NodeAddress{claim.node_address}) < 0 || users.at(claim.node_address) > 1)
      continue;
    if (const auto kept = Controller(bus, claim.node_address).calibration())
      boards.push_back(from_wire(*kept, to_text(claim.unique_id)));
  }
  return boards;
}

std::map<std::string, int> kept_revisions(Bus& bus) {
  std::map<std::string, int> revisions;
  const auto claims = bus.discover();
  const auto users = users_of_addresses(claims);
  for (const wire::NodeClaim& claim : claims) {
    if (!claim.has_table || users.at(claim.node_address) > 1) continue;
    try {
      if (const auto kept = Controller(bus, claim.node_address).calibration())
        revisions[to_text(claim.unique_id)] = kept->revision;
    } catch (const DeviceError&) {
      // The stored calibration of a silent controller is unknown; callers that need the controller report that it is
      // silent.
    }
  }
  return revisions;
}

bool write_and_compare(Controller& controller, const wire::Calibration& wanted, const std::string& serial) {
  if (!controller.set_calibration(wanted)) return false;
  if (controller.calibration() != wanted)
    throw DeviceError(
        fmt::format("controller {} gives back another calibration than it was given; write it again", serial));
  return true;
}

bool keep_in_controller(Bus& bus, const wire::NodeClaim& claim, const design::BoardCalibration& board) {
  Controller controller(bus, claim.node_address);
  return write_and_compare(controller, to_wire(board), to_text(claim.unique_id));
}

bool forget_in_controller(Bus& bus, const wire::NodeClaim& claim) {
  Controller controller(bus, claim.node_address);
  auto kept = controller.calibration();
  if (!kept) return false;
  kept->count = 0;
  return controller.set_calibration(*kept);
}

}  // namespace triskin::session
