// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/logic/icub/icub_board.hpp"
#include "triskin/logic/sampling/module_reading.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::fw {

/// Computes the values of the iCub stream from the readings of the modules, as an MTB4 board does. See docs/icub.md.
class IcubTriangles {
 public:
  /// Makes the next reading of every taxel its rest value.
  void calibrate() { known_ = {}; }
  /// Updates the module in row `row` of the table with a reading.
  void read(std::size_t row, const ModuleReading& sample);
  /// Returns the values for the module in row `row` at place `triangle`. A module that was not read or not calibrated
  /// yet counts as at rest, because a host would take zeros for full pressure.
  [[nodiscard]] wire::IcubTaxels taxels(std::size_t row, const ModuleReading& sample, const IcubBoard& board,
                                        std::size_t triangle) const;
  /// Returns the frame contents for a place where the table has no module.
  [[nodiscard]] static wire::IcubTaxels nobody(const IcubBoard& board, std::size_t triangle);

 private:
  [[nodiscard]] int rise(std::size_t row, const ModuleReading& sample, std::size_t taxel,
                         wire::icub::SkinType type) const;

  std::array<std::array<std::uint16_t, layout::kTaxelsPerModule>, layout::kMaxModules> rest_{};
  // The compensation had restarted this often when rest_ was taken.
  std::array<std::uint8_t, layout::kMaxModules> restarts_{};
  std::array<std::uint16_t, layout::kMaxModules> known_{};  // Bit t says that taxel t has a rest value.
};

}  // namespace triskin::fw
