// SPDX-License-Identifier: Apache-2.0
#include "pll.hpp"

#include "triskin/board/registers/system.hpp"

namespace triskin::board {

bool wait_for(Register reg, std::uint32_t mask, std::uint32_t looks) {
  for (std::uint32_t k = 0; k < looks; ++k) {
    if (reg.any(mask)) return true;
  }
  return false;
}

bool start_pll(std::uint32_t source, PllSetting setting, std::uint32_t looks) {
  rcc_reg::kPllCfgr.write(source | (setting.divider - 1) << rcc_reg::kPllMShift |
                          setting.factor << rcc_reg::kPllNShift |
                          rcc_reg::kPllREnable);  // R = 2 is coded as 0 in bits 25 and 26.
  rcc_reg::kCr.set(rcc_reg::kPllOn);
  if (wait_for(rcc_reg::kCr, rcc_reg::kPllReady, looks)) return true;
  rcc_reg::kCr.clear(rcc_reg::kPllOn);
  for (std::uint32_t k = 0; k < looks && rcc_reg::kCr.any(rcc_reg::kPllReady); ++k) {
  }
  return false;
}

}  // namespace triskin::board
