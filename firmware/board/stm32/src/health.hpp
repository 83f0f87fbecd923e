// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/ports/ports.hpp"

namespace triskin::board {

/// Reports the state of this board, FD11 and FD12.
class Stm32Monitor final : public fw::BoardMonitor {
 public:
  [[nodiscard]] wire::BoardHealth health() const override;
  [[nodiscard]] std::optional<wire::Crash> crash() const override;
  void forget_crash() override;
  bool protect_loader(bool on) override;
};

extern Stm32Monitor monitor;

/// Measures how much of the stack was never touched. Cost: a look at each word of it.
void measure_stack();

}  // namespace triskin::board
