// SPDX-License-Identifier: Apache-2.0
#include "line.hpp"
#include "triskin/board/board_config.hpp"
#include "triskin/board/registers/i2c.hpp"
#include "triskin/board/registers/system.hpp"

namespace triskin::board {

using namespace i2c_reg;

namespace {

// The first four channels receive, the others send.
constexpr dma_reg::Channel receiver(unsigned line) {
  return {dma_reg::kBase, line};
}
constexpr dma_reg::Channel sender(unsigned line) {
  return {dma_reg::kBase, 4 + line};
}
void route(unsigned channel, std::uint32_t request) {
  Register(dma_reg::kMuxBase + dma_reg::kMuxChannelBytes * channel).write(request);
}

}  // namespace

constexpr std::array<LinePlace, layout::kLines> line_places{{
    {kI2c1, pins::kScl1, pins::kSda1, pins::kFunctionI2c1, kI2c1Event, kI2c1Error, receiver(0), sender(0)},
    {kI2c2, pins::kScl2, pins::kSda2, pins::kFunctionI2c2, kI2c2Event, kI2c2Error, receiver(1), sender(1)},
    {kI2c3, pins::kScl3, pins::kSda3, pins::kFunctionI2c3, kI2c3Event, kI2c3Error, receiver(2), sender(2)},
    {kI2c4, pins::kScl4, pins::kSda4, pins::kFunctionI2c4, kI2c4Event, kI2c4Error, receiver(3), sender(3)},
}};

void connect_lines() {
  rcc_reg::kAhb1Enr.set(rcc_reg::kDma1 | rcc_reg::kDmaMux);
  rcc_reg::kApb1Enr1.set(rcc_reg::kI2c1 | rcc_reg::kI2c2 | rcc_reg::kI2c3);
  rcc_reg::kApb1Enr2.set(rcc_reg::kI2c4);
  (void)rcc_reg::kApb1Enr2.read();
  for (unsigned line = 0; line < line_places.size(); ++line) {
    route(line, dma_reg::kI2c1Receive + dma_reg::kI2cRequests * line);
    route(4 + line, dma_reg::kI2c1Send + dma_reg::kI2cRequests * line);
  }
}

}  // namespace triskin::board
