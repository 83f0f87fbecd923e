// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/gpio.hpp"

/// The board is for installed iCub patches, whose four data wires share one clock wire: the SCL pins of all four I²C
/// blocks are tied to it, and one of them works at a time. CAN uses the pins of USB, which the board does not have, and
/// its light is on when the pin is low. It was made as docs/port.md describes.
namespace triskin::board {

/// Pins are from the data sheet DS12288, table 13.
namespace pins {
inline constexpr Pin kScl1{'A', 15}, kSda1{'B', 9}, kScl2{'A', 9}, kSda2{'A', 8}, kScl3{'C', 8}, kSda3{'C', 11},
    kScl4{'C', 6}, kSda4{'C', 7};
inline constexpr std::uint32_t kFunctionI2c1 = 4, kFunctionI2c2 = 4, kFunctionI2c3 = 8, kFunctionI2c4 = 8;
inline constexpr Pin kCanReceive{'A', 11}, kCanSend{'A', 12};
inline constexpr std::uint32_t kFunctionCan = 9;
inline constexpr Pin kBoot{'B', 8};
inline constexpr Pin kChainClock{'B', 13}, kChainIn{'B', 14}, kChainOut{'B', 15}, kChainEnable{'B', 12},
    kChainEnable2{'B', 10}, kChainLatch{'B', 11};
inline constexpr std::uint32_t kFunctionSpi2 = 5;
inline constexpr Pin kLogSend{'B', 3};
inline constexpr std::uint32_t kFunctionLog = 7;
inline constexpr Pin kLight{'B', 0};
}  // namespace pins

namespace config {
inline constexpr bool kLightOnWhenHigh = false;
inline constexpr bool kUsb = false;
inline constexpr bool kOneScl = true;
}  // namespace config

}  // namespace triskin::board
