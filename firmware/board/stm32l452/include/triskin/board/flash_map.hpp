// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>

/// docs/flash_layout.md explains the layout of the flash, which is that of the STM32G474. The linker scripts repeat
/// the origins, and the build compares them.
namespace triskin::board::flash_map {

// The chip has one bank, so none begins inside its flash.
inline constexpr std::uint32_t kBase = 0x08000000, kEnd = 0x08080000, kBank2 = kEnd;
inline constexpr std::size_t kPageBytes = 2048, kUnitBytes = 8;
inline constexpr std::uint32_t kLoader = kBase, kLoaderBytes = 0x4000;
// A slot has 240 KB, and its last page holds the slot's records.
inline constexpr std::uint32_t kSlotBytes = 0x3C000;
inline constexpr std::uint32_t kSlots[2] = {0x08004000, 0x08040000};
inline constexpr std::uint32_t kTables = 0x0807C000, kTablesBytes = 0x4000;
static_assert(kSlots[0] + kSlotBytes == kSlots[1] && kSlots[1] + kSlotBytes == kTables &&
              kTables + kTablesBytes == kEnd);

}  // namespace triskin::board::flash_map
