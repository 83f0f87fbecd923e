// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/logic/icub/icub_board.hpp"
#include "triskin/logic/sampling/module_sample.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::fw {

/// Makes the values of the iCub stream from the readings of the modules, as an MTB4 board does. docs/icub.md.
class IcubTriangles {
 public:
  /// The next reading of every taxel is its value at rest.
  void calibrate() { known_ = {}; }
  /// A new reading of the module in row `row` of the table.
  void read(std::size_t row, const ModuleSample& sample);
  /// What is sent for the module in row `row` at place `triangle`. A module without a reading, or not yet calibrated,
  /// is at rest: a host takes zeros for full pressure.
  [[nodiscard]] wire::IcubTaxels taxels(std::size_t row, const ModuleSample& sample, const IcubBoard& board,
                                        std::size_t triangle) const;
  /// What is sent for a place where the table has no module.
  [[nodiscard]] static wire::IcubTaxels nobody(const IcubBoard& board, std::size_t triangle);

 private:
  [[nodiscard]] int rise(std::size_t row, const ModuleSample& sample, std::size_t taxel,
                         wire::icub::SkinType type) const;

  std::array<std::array<std::uint16_t, layout::kTaxelsPerModule>, layout::kMaxModules> rest_{};
  std::array<std::uint8_t, layout::kMaxModules> restarts_{};  // Restarts of the compensation when rest_ was taken.
  std::array<std::uint16_t, layout::kMaxModules> known_{};    // Bit t: taxel t has a value at rest.
};

}  // namespace triskin::fw
