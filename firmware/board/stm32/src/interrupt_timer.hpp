// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/budget.hpp"
#include "triskin/board/registers/system.hpp"

namespace triskin::board {

/// Measures the time of one interrupt handler for the budget.
class InterruptTimer {
 public:
  InterruptTimer() : start_(tim2_reg::kCnt.read()) {}
  ~InterruptTimer() {
    const std::uint32_t took = tim2_reg::kCnt.read() - start_;
    if (took > triskin_budget.worst_interrupt_us) triskin_budget.worst_interrupt_us = took;
    asm volatile("dsb" ::: "memory");  // A store may not overlap the return (Cortex-M4 erratum 838869).
  }
  InterruptTimer(const InterruptTimer&) = delete;
  InterruptTimer& operator=(const InterruptTimer&) = delete;

 private:
  std::uint32_t start_;
};

}  // namespace triskin::board
