// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace triskin::board {

/// What the firmware measures about itself. At a fixed symbol (`triskin_budget`), so that a debugger or the modelled
/// machine reads it.
struct Budget {
  std::uint32_t loops = 0;          ///< passes of the main loop
  std::uint32_t worst_loop_us = 0;  ///< longest pass, sleep left out
  std::uint32_t worst_interrupt_us = 0;
  std::uint32_t stack_free_bytes = 0;  ///< of the painted stack, never touched so far
  std::uint64_t idle_us = 0;           ///< spent in WFI since start
  std::uint32_t reset_cause = 0;       ///< RCC_CSR as found at start
  std::uint32_t ecc_faults = 0;        ///< flash units read with two wrong bits: torn by a power cut
  std::uint32_t can_lost = 0;          ///< frames that found the receive queue full
  std::uint32_t flash_errors = 0;      ///< erase or program refused
};

}  // namespace triskin::board

extern "C" triskin::board::Budget triskin_budget;
