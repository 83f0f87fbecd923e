// SPDX-License-Identifier: Apache-2.0
#include "flash_area.hpp"

#include <cstring>

#include "triskin/board/board.hpp"
#include "triskin/board/flash_map.hpp"

namespace triskin::board {
namespace {

constinit Stm32FlashArea slot_a(flash_map::kSlots[0], flash_map::kSlotBytes),
    slot_b(flash_map::kSlots[1], flash_map::kSlotBytes);

}  // namespace

constinit Stm32FlashArea table_flash(flash_map::kTables, flash_map::kTablesBytes);
constinit boot::SlotStore application_slots({&slot_a, &slot_b}, {flash_map::kSlots[0], flash_map::kSlots[1]});

int running_slot() {
  const std::uint32_t origin = image_origin();
  return origin == flash_map::kSlots[0] ? 0 : origin == flash_map::kSlots[1] ? 1 : -1;
}

std::size_t Stm32FlashArea::page_bytes() const {
  return flash_map::kPageBytes;
}
std::size_t Stm32FlashArea::program_bytes() const {
  return flash_map::kUnitBytes;
}

bool Stm32FlashArea::erase_page(std::size_t offset) {
  feed_watchdog();
  return offset < size_bytes_ && erase_flash_page(base_ + static_cast<std::uint32_t>(offset));
}

bool Stm32FlashArea::program(std::size_t offset, Bytes bytes) {
  if (bytes.size() % flash_map::kUnitBytes != 0 || offset + bytes.size() > size_bytes_) return false;
  for (std::size_t at = 0; at < bytes.size(); at += flash_map::kUnitBytes) {
    std::uint32_t words[2];
    std::memcpy(words, bytes.data() + at, sizeof words);
    if (!program_flash_unit(base_ + static_cast<std::uint32_t>(offset + at), words[0], words[1])) return false;
  }
  return true;
}

Bytes Stm32FlashArea::bytes() const {
  return {reinterpret_cast<const std::uint8_t*>(base_), size_bytes_};
}

}  // namespace triskin::board
