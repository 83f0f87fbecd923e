// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/gpio.hpp"

/// The board is a NUCLEO-L452RE with a CAN transceiver and four separate lines. docs/port.md and
/// docs/port.md explain each constant.
namespace triskin::board {

/// Pins and their alternate function numbers are from the data sheet DS11912, tables of alternate functions (LQFP64 has
/// all of them).
namespace pins {
inline constexpr Pin kScl1{'B', 8}, kSda1{'B', 9}, kScl2{'B', 10}, kSda2{'B', 11}, kScl3{'C', 0}, kSda3{'C', 1},
    kScl4{'B', 6}, kSda4{'B', 7};
inline constexpr std::uint32_t kFunctionI2c1 = 4, kFunctionI2c2 = 4, kFunctionI2c3 = 4, kFunctionI2c4 = 5;
inline constexpr Pin kCanReceive{'A', 11}, kCanSend{'A', 12};
inline constexpr std::uint32_t kFunctionCan = 9;
inline constexpr Pin kBoot{'H', 3};  // BOOT0 has a pin of its own.
inline constexpr Pin kChainClock{'B', 13}, kChainIn{'B', 14}, kChainOut{'B', 15}, kChainEnable{'B', 12},
    kChainEnable2{'C', 6}, kChainLatch{'C', 7};
inline constexpr std::uint32_t kFunctionSpi2 = 5;
inline constexpr Pin kLogSend{'A', 2};  // The ST-LINK of a Nucleo board makes a serial port of this pin.
inline constexpr std::uint32_t kFunctionLog = 7;
inline constexpr Pin kLight{'A', 5};  // The light is LD2 of a Nucleo board.
}  // namespace pins

namespace config {
inline constexpr bool kLightOnWhenHigh = true;
inline constexpr bool kUsb = false;     // PA11 and PA12 are those of CAN.
inline constexpr bool kOneScl = false;  // Each line has its own clock wire.
/// The board has a crystal of this many MHz at HSE; 0 means none. A Nucleo board is delivered without X3, and the image
/// then runs from the internal oscillator (± 1 %). CAN over the whole range of temperature needs the crystal.
inline constexpr std::uint32_t kCrystal_mhz = 8;
inline constexpr bool kClockInput = false;  ///< True means that an oscillator drives OSC_IN instead of a crystal.
}  // namespace config

}  // namespace triskin::board
