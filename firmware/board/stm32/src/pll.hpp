// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/board/pll_setting.hpp"
#include "triskin/board/registers/register.hpp"

namespace triskin::board {

/// Polls a register until a bit of the mask is set, at most `looks` times. Returns false if none was.
[[nodiscard]] bool wait_for(Register reg, std::uint32_t mask, std::uint32_t looks);

/// Starts the PLL from a source (a value of RCC_PLLCFGR) and waits at most `looks` polls. Returns false, with the PLL
/// off, if it does not lock.
[[nodiscard]] bool start_pll(std::uint32_t source, PllSetting setting, std::uint32_t looks);

}  // namespace triskin::board
