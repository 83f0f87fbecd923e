// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/gpio.hpp"

/// Function of each pin, and its alternate function number: data sheet DS12288, table 13 (LQFP64 has all of them).
namespace triskin::board::pins {

inline constexpr Pin kScl1{'A', 15}, kSda1{'B', 7}, kScl2{'A', 9}, kSda2{'A', 8}, kScl3{'C', 8}, kSda3{'C', 9},
    kScl4{'C', 6}, kSda4{'C', 7};
inline constexpr std::uint32_t kFunctionI2c1 = 4, kFunctionI2c2 = 4, kFunctionI2c3 = 8, kFunctionI2c4 = 8;
inline constexpr Pin kCanReceive{'B', 8}, kCanSend{'B', 9};
inline constexpr std::uint32_t kFunctionCan = 9;
inline constexpr Pin kChainClock{'B', 13}, kChainIn{'B', 14}, kChainOut{'B', 15}, kChainEnable{'B', 12},
    kChainEnable2{'B', 10}, kChainLatch{'B', 11};
inline constexpr std::uint32_t kFunctionSpi2 = 5;
inline constexpr Pin kLight{'A', 5};  // LD2 of a Nucleo board

}  // namespace triskin::board::pins
