// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/board/registers/gpio.hpp"

/// A board for the tests: an STM32L452 that uses its USB, so CAN and line 1 are at other pins than on the
/// NUCLEO-L452RE.
namespace triskin::board {

/// Pins and their alternate function numbers are from the data sheet DS11912, tables of alternate functions (LQFP64 has
/// all of them).
namespace pins {
inline constexpr Pin kScl1{'A', 9}, kSda1{'A', 10}, kScl2{'B', 10}, kSda2{'B', 11}, kScl3{'C', 0}, kSda3{'C', 1},
    kScl4{'B', 6}, kSda4{'B', 7};
inline constexpr std::uint32_t kFunctionI2c1 = 4, kFunctionI2c2 = 4, kFunctionI2c3 = 4, kFunctionI2c4 = 5;
inline constexpr Pin kCanReceive{'B', 8}, kCanSend{'B', 9};
inline constexpr std::uint32_t kFunctionCan = 9;
inline constexpr Pin kBoot{'H', 3};  // BOOT0 has a pin of its own.
inline constexpr Pin kChainClock{'B', 13}, kChainIn{'B', 14}, kChainOut{'B', 15}, kChainEnable{'B', 12},
    kChainEnable2{'C', 6}, kChainLatch{'C', 7};
inline constexpr std::uint32_t kFunctionSpi2 = 5;
inline constexpr Pin kLogSend{'A', 2};
inline constexpr std::uint32_t kFunctionLog = 7;
inline constexpr Pin kLight{'A', 5};
}  // namespace pins

namespace config {
inline constexpr bool kLightOnWhenHigh = true;
inline constexpr bool kUsb = true;
inline constexpr bool kOneScl = false;  // Each line has its own clock wire.
inline constexpr std::uint32_t kCrystal_mhz = 8;
inline constexpr bool kClockInput = false;  ///< True means that an oscillator drives OSC_IN instead of a crystal.
}  // namespace config

}  // namespace triskin::board
