// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/board/board_config.hpp"
#include "triskin/board/registers/gpio.hpp"
#include "triskin/board/registers/system.hpp"

namespace triskin::board {

/// Meanings of the board's light (docs/program_board.md). A pattern has ten steps of a tenth of a second, bit 0 first.
enum class Light : std::uint16_t {
  kNoTable = 0b00'0000'0001,    ///< One short flash means that the application runs without a table.
  kSampling = 0b00'0001'1111,   ///< The light is on for half a second and off for half a second.
  kStreaming = 0b01'1111'1111,  ///< The light is on with a short gap.
  kFault = 0b01'0101'0101,      ///< The light flashes fast because a module is faulty.
  kLoader = 0b00'0000'0101,     ///< Two short flashes mean that the loader waits for a host.
};

inline void open_light() {
  open_port(pins::kLight);
  Gpio(pins::kLight).mode(PinMode::kOutput);
}

/// Updates the light; call it at least ten times a second.
inline void show(Light light, std::uint64_t now_us) {
  const auto step = static_cast<unsigned>(now_us / 100'000 % 10);
  Gpio(pins::kLight).drive(((static_cast<unsigned>(light) >> step & 1U) != 0) == config::kLightOnWhenHigh);
}

}  // namespace triskin::board
