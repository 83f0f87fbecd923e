// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/logic/sampling/compensation.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::fw {

/// What is known about one module of the table: its state and its last sample.
struct ModuleSample {
  wire::ModuleState state = wire::ModuleState::kUnknown;
  std::array<std::uint16_t, layout::kTaxelsPerModule> raw{};
  std::uint16_t valid = 0;    ///< bit t: taxel t was read in the last sequence, is inside its range and not frozen
  std::uint32_t number = 0;   ///< counts the sequences that were to be read: one left out is a lost sample
  std::uint64_t time_us = 0;  ///< end of the sequence
  bool fresh = false;         ///< set by the sampler with each reading or failure, cleared by who sends it on
  std::uint8_t unheard = 0;   ///< nominal sequences since the sampler reported something
  Compensation compensation;

  /// Takes the results of one sequence; `frozen` has a bit for each taxel that does not change any more. Sets the
  /// validity of each taxel and the state, and feeds the compensation.
  void store(const ad7147::Results& results, std::uint16_t frozen);
  /// Nothing was read, for the reason `why`: no taxel is valid.
  void store_failure(wire::ModuleState why);
  /// Hands over what was stored: the next sample number, `at_us`, fresh.
  void publish(std::uint64_t at_us);
};

}  // namespace triskin::fw
