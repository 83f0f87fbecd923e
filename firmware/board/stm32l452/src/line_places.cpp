// SPDX-License-Identifier: Apache-2.0
#include "line.hpp"
#include "triskin/board/board_config.hpp"
#include "triskin/board/registers/i2c.hpp"
#include "triskin/board/registers/system.hpp"

namespace triskin::board {

using namespace i2c_reg;

namespace {

// The manual counts channels from 1 (chapter on the DMA controller, table of requests).
constexpr dma_reg::Channel dma1(unsigned number) {
  return {dma_reg::kBase, number - 1};
}
constexpr dma_reg::Channel dma2(unsigned number) {
  return {dma_reg::kDma2, number - 1};
}
void select(std::uint32_t controller, unsigned number, std::uint32_t request) {
  const unsigned shift = dma_reg::kSelectionBits * (number - 1);
  const std::uint32_t mask = (1U << dma_reg::kSelectionBits) - 1;
  Register(controller + dma_reg::kSelection).modify(mask << shift, request << shift);
}

}  // namespace

constexpr std::array<LinePlace, layout::kLines> line_places{{
    {kI2c1, pins::kScl1, pins::kSda1, pins::kFunctionI2c1, kI2c1Event, kI2c1Error, dma1(7), dma1(6)},
    {kI2c2, pins::kScl2, pins::kSda2, pins::kFunctionI2c2, kI2c2Event, kI2c2Error, dma1(5), dma1(4)},
    {kI2c3, pins::kScl3, pins::kSda3, pins::kFunctionI2c3, kI2c3Event, kI2c3Error, dma1(3), dma1(2)},
    {kI2c4, pins::kScl4, pins::kSda4, pins::kFunctionI2c4, kI2c4Event, kI2c4Error, dma2(1), dma2(2)},
}};

void connect_lines() {
  rcc_reg::kAhb1Enr.set(rcc_reg::kDma1 | rcc_reg::kDma2);
  rcc_reg::kApb1Enr1.set(rcc_reg::kI2c1 | rcc_reg::kI2c2 | rcc_reg::kI2c3);
  rcc_reg::kApb1Enr2.set(rcc_reg::kI2c4);
  (void)rcc_reg::kApb1Enr2.read();
  for (const unsigned number : {2U, 3U, 4U, 5U, 6U, 7U}) select(dma_reg::kBase, number, dma_reg::kI2cRequest);
  for (const unsigned number : {1U, 2U}) select(dma_reg::kDma2, number, dma_reg::kI2c4Request);
}

}  // namespace triskin::board
