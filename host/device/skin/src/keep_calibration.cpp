// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/skin/keep_calibration.hpp"

#include <algorithm>
#include <utility>

#include "triskin/session/controller.hpp"
#include "triskin/session/controller_calibration.hpp"

namespace triskin::skin {
namespace {

const wire::NodeClaim* claim_of(std::span<const wire::NodeClaim> claims, const std::string& serial) {
  const auto claim =
      std::ranges::find_if(claims, [&](const wire::NodeClaim& c) { return session::to_text(c.unique_id) == serial; });
  return claim == claims.end() ? nullptr : &*claim;
}

// Modules that were not measured keep the calibration that they have with this patch. What both are calibrated for is
// the smaller pressure.
void add_earlier_places(design::BoardCalibration& board, const design::BoardCalibration& earlier) {
  if (earlier.design_id != board.design_id || earlier.patch != board.patch) return;
  for (const design::PlaceCalibration& place : earlier.places) {
    if (board.at(place.line, place.address) != nullptr) continue;
    board.places.push_back(place);
    board.max_kpa = std::min(board.max_kpa, earlier.max_kpa);
  }
}

}  // namespace

std::vector<KeptCalibration> keep_calibration(LiveBus& bus, LiveCover& cover, CalibrationOutcome outcome) {
  const CalibrationStore store;
  const session::Bus::Uninterrupted guard(bus.bus());  // A person who ends a calibration keeps what was measured.
  bus.find_controllers(RestSource::kPresent);
  const auto kept = session::kept_in_controllers(bus.bus(), cover.design(), bus.claims());
  std::vector<KeptCalibration> all;
  for (design::BoardCalibration& board : outcome.boards) {
    const auto before = std::ranges::find(kept, board.serial, &design::BoardCalibration::serial);
    if (const auto here = store.read(board.serial)) add_earlier_places(board, *here);
    if (before != kept.end()) add_earlier_places(board, *before);
    board = store.renew(std::move(board), before == kept.end() ? 0 : before->revision);
    const wire::NodeClaim* claim = claim_of(bus.claims(), board.serial);
    all.push_back({board, claim != nullptr && session::keep_in_controller(bus.bus(), *claim, board)});
  }
  cover.keep_rest(outcome.rest);
  return all;
}

std::vector<KeptCalibration> keep_calibration_file(LiveBus& bus, const LiveCover& cover,
                                                   const std::filesystem::path& file) {
  const CalibrationStore store;
  bus.find_controllers(RestSource::kPresent);
  std::vector<KeptCalibration> all;
  for (const design::BoardCalibration& board : design::read_calibration(file)) {
    const wire::NodeClaim* claim = claim_of(bus.claims(), board.serial);
    if (claim == nullptr || design::patch_at(cover.design(), layout::NodeAddress{claim->node_address}) < 0) continue;
    store.write(board);
    all.push_back({board, session::keep_in_controller(bus.bus(), *claim, board)});
  }
  return all;
}

std::vector<std::string> forget_calibration(LiveBus& bus, const LiveCover& cover) {
  const CalibrationStore store;
  bus.find_controllers(RestSource::kPresent);
  std::vector<std::string> forgotten;
  for (const wire::NodeClaim& claim : bus.claims()) {
    if (design::patch_at(cover.design(), layout::NodeAddress{claim.node_address}) < 0) continue;
    std::string serial = session::to_text(claim.unique_id);
    const bool here = store.forget(serial), there = session::forget_in_controller(bus.bus(), claim);
    if (here || there) forgotten.push_back(std::move(serial));
  }
  return forgotten;
}

}  // namespace triskin::skin
