// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/gpio.hpp"

/// The board is a NUCLEO-G474RE with a CAN FD transceiver and four separate lines. docs/port.md explains each
/// constant.
namespace triskin::board {

/// Pins and their alternate function numbers are from the data sheet DS12288, table 13 (LQFP64 has all of them).
namespace pins {
inline constexpr Pin kScl1{'A', 15}, kSda1{'B', 7}, kScl2{'A', 9}, kSda2{'A', 8}, kScl3{'C', 8}, kSda3{'C', 9},
    kScl4{'C', 6}, kSda4{'C', 7};
inline constexpr std::uint32_t kFunctionI2c1 = 4, kFunctionI2c2 = 4, kFunctionI2c3 = 8, kFunctionI2c4 = 8;
inline constexpr Pin kCanReceive{'B', 8}, kCanSend{'B', 9};
inline constexpr std::uint32_t kFunctionCan = 9;
inline constexpr Pin kBoot{'B', 8};  // Every STM32G474 in this package has BOOT0 here.
inline constexpr Pin kChainClock{'B', 13}, kChainIn{'B', 14}, kChainOut{'B', 15}, kChainEnable{'B', 12},
    kChainEnable2{'B', 10}, kChainLatch{'B', 11};
inline constexpr std::uint32_t kFunctionSpi2 = 5;
inline constexpr Pin kLogSend{'A', 2};  // The ST-LINK of a Nucleo board makes a serial port of this pin.
inline constexpr std::uint32_t kFunctionLog = 7;
inline constexpr Pin kLight{'A', 5};  // The light is LD2 of a Nucleo board.
}  // namespace pins

namespace config {
inline constexpr bool kLightOnWhenHigh = true;
inline constexpr bool kUsb = true;      // PA11 and PA12 lead to a USB socket.
inline constexpr bool kOneScl = false;  // Each line has its own clock wire.
}  // namespace config

}  // namespace triskin::board
