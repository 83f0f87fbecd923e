// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/logic/sampling/compensation.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::fw {

/// Each module of the table has its state and its last sample here.
struct ModuleReading {
  wire::ModuleState state = wire::ModuleState::kUnknown;
  std::array<std::uint16_t, layout::kTaxelsPerModule> raw{};
  /// Bit t says that taxel t was read in the last sequence, is inside its range and not frozen.
  std::uint16_t valid = 0;
  std::uint32_t number = 0;   ///< All sequences that had to be read are counted, so a gap is a lost sample.
  std::uint64_t time_us = 0;  ///< The sequence ended at this time.
  bool fresh = false;         ///< The sampler sets it with each reading or failure, and the sender clears it.
  std::uint8_t unheard = 0;   ///< The sampler has reported nothing for this many nominal sequences.
  Compensation compensation;

  /// Stores the results of one sequence; `frozen` has a bit for each frozen taxel. Sets the validity of each taxel and
  /// the state, and updates the compensation.
  void store(const ad7147::Results& results, std::uint16_t frozen);
  /// Stores that nothing was read because of `why`; no taxel is valid.
  void store_failure(wire::ModuleState why);
  /// Publishes what was stored, with the next sample number and `at_us`, as fresh.
  void publish(std::uint64_t at_us);
};

}  // namespace triskin::fw
