// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/icub/icub_triangles.hpp"

#include <algorithm>

namespace triskin::fw {

using wire::ModuleState;
using wire::icub::SkinType;

namespace {

constexpr int kTop = 255;

bool has_reading(const ModuleReading& s) {
  return s.valid != 0 || s.state == ModuleState::kSaturated || s.state == ModuleState::kFrozen;
}
// A chip answered, but its reading is useless.
bool misread(ModuleState s) {
  return s == ModuleState::kLineStuck || s == ModuleState::kDuplicate || s == ModuleState::kLostConfiguration;
}

// Stores `rise`, in the converter's counts, limited, shifted and reported as by an MTB4 board.
void set_taxel(wire::IcubTaxels& out, std::size_t taxel, int rise, int no_load, int shift) {
  const int top = (kTop - no_load) << shift, bottom = no_load << shift;
  const int value = rise <= -top ? kTop : rise >= bottom ? 0 : no_load - (rise >> shift);
  out.value[taxel] = static_cast<std::uint8_t>(value);
  if ((rise < 0 && rise <= -2 * top) || (rise > 0 && rise >= 2 * bottom))
    out.out_of_range = static_cast<std::uint16_t>(out.out_of_range | 1U << taxel);
}

}  // namespace

void IcubTriangles::read(std::size_t row, const ModuleReading& sample) {
  if (sample.compensation.restarts() != restarts_[row]) known_[row] = 0;  // The converter now has other offsets.
  restarts_[row] = sample.compensation.restarts();
  for (std::size_t t = 0; t < sample.raw.size(); ++t) {
    const auto bit = static_cast<std::uint16_t>(1U << t);
    if ((sample.valid & ~known_[row] & bit) == 0) continue;
    rest_[row][t] = sample.raw[t];
    known_[row] = static_cast<std::uint16_t>(known_[row] | bit);
  }
}

// Pressure lowers the result of our converters but raises that of an MTB4 board.
int IcubTriangles::rise(std::size_t row, const ModuleReading& sample, std::size_t taxel, SkinType type) const {
  constexpr int kBeyond = 1 << 30;  // Limits after the shift are smaller.
  const std::uint16_t raw = sample.raw[taxel];
  if (!ad7147::in_range(raw)) return raw == 0 ? kBeyond : -kBeyond;
  if ((known_[row] >> taxel & 1) == 0) return 0;
  if (type == SkinType::kCompensated) return -sample.compensation.change(taxel);
  return static_cast<int>(rest_[row][taxel]) - raw;
}

wire::IcubTaxels IcubTriangles::nobody(const IcubBoard& board, std::size_t triangle) {
  wire::IcubTaxels out;
  out.module = static_cast<std::uint8_t>(triangle);
  out.value.fill(static_cast<std::uint8_t>(board.no_load()));
  out.not_connected = true;
  return out;
}

wire::IcubTaxels IcubTriangles::taxels(std::size_t row, const ModuleReading& sample, const IcubBoard& board,
                                       std::size_t triangle) const {
  wire::IcubTaxels out = nobody(board, triangle);
  out.no_acknowledge = misread(sample.state);
  out.not_connected = !has_reading(sample) && !out.no_acknowledge;
  if (!has_reading(sample)) return out;
  for (std::size_t t = 0; t < out.value.size(); ++t) {
    if (board.skin_type() == SkinType::kRaw)
      out.value[t] = static_cast<std::uint8_t>(-sample.raw[t]);
    else
      set_taxel(out, t, rise(row, sample, t, board.skin_type()), board.no_load(), board.shift(triangle));
  }
  return out;
}

}  // namespace triskin::fw
