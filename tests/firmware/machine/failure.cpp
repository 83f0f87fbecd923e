// SPDX-License-Identifier: GPL-3.0-or-later
#include "failure.hpp"

namespace triskin::machine {
namespace {

constexpr std::uint16_t kOtherId = 0x1240;
constexpr std::size_t kSaturatedTaxel = 7;
constexpr int kFrozenTaxel = 2;
constexpr double kBeyondRange_counts = 60'000;

}  // namespace

wire::ModuleState state_of(Failure failure) {
  switch (failure) {
    case Failure::kAbsent:
    case Failure::kMoved:
      return wire::ModuleState::kAbsent;
    case Failure::kWrongId:
      return wire::ModuleState::kWrongId;
    case Failure::kDip:
      return wire::ModuleState::kLostConfiguration;
    case Failure::kSaturated:
      return wire::ModuleState::kSaturated;
    case Failure::kFrozen:
      return wire::ModuleState::kFrozen;
    case Failure::kSda:
    case Failure::kScl:
      break;
  }
  return wire::ModuleState::kLineStuck;
}

void inject(Failure failure, SkinLine& line, int m, std::uint64_t now_us) {
  SkinModule& module = *line.modules[static_cast<std::size_t>(m / 4)];
  switch (failure) {
    case Failure::kAbsent:
      module.present = false;
      return;
    case Failure::kMoved:
      module.address = static_cast<std::uint8_t>((m / 4 + 1) % 4);
      return;
    case Failure::kWrongId:
      SkinLine::exchange(module, kOtherId, m);
      return;
    case Failure::kDip:
      line.dip(module, now_us);
      return;
    case Failure::kSaturated:
      module.source.level[kSaturatedTaxel] += kBeyondRange_counts;
      return;
    case Failure::kFrozen:
      line.freeze(module, kFrozenTaxel, now_us);
      return;
    case Failure::kSda:
      line.sda_held = true;
      return;
    case Failure::kScl:
      line.scl_held = true;
      return;
  }
}

void repair(Failure failure, SkinLine& line, int m) {
  SkinModule& module = *line.modules[static_cast<std::size_t>(m / 4)];
  switch (failure) {
    case Failure::kAbsent:
      module.present = true;
      return;
    case Failure::kMoved:
      module.address = static_cast<std::uint8_t>(m / 4);
      return;
    case Failure::kWrongId:
      SkinLine::exchange(module, hardware::Ad7147::kDeviceId, m);
      return;
    case Failure::kDip:
      return;
    case Failure::kSaturated:
      module.source.level[kSaturatedTaxel] -= kBeyondRange_counts;
      return;
    case Failure::kFrozen:
      module.frozen = 0;
      return;
    case Failure::kSda:
      line.sda_held = false;
      return;
    case Failure::kScl:
      line.scl_held = false;
      return;
  }
}

}  // namespace triskin::machine
