// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/board/board_config.hpp"
#include "triskin/board/registers/gpio.hpp"
#include "triskin/board/registers/system.hpp"

namespace triskin::board {

/// What the light of the board says (docs/firmware_board.md). A pattern has ten steps of a tenth of a second, bit 0
/// first.
enum class Light : std::uint16_t {
  kNoTable = 0b00'0000'0001,    ///< one short flash: the application runs and has no table
  kSampling = 0b00'0001'1111,   ///< half a second on, half off
  kStreaming = 0b01'1111'1111,  ///< on, with a short gap
  kFault = 0b01'0101'0101,      ///< fast: a module is not in order
  kLoader = 0b00'0000'0101,     ///< two short flashes: the loader waits for a host
};

inline void open_light() {
  open_port(pins::kLight);
  Gpio(pins::kLight).mode(PinMode::kOutput);
}

/// Called at least ten times a second.
inline void show(Light light, std::uint64_t now_us) {
  const auto step = static_cast<unsigned>(now_us / 100'000 % 10);
  Gpio(pins::kLight).drive(((static_cast<unsigned>(light) >> step & 1U) != 0) == config::kLightOnWhenHigh);
}

}  // namespace triskin::board
