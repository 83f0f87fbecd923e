// SPDX-License-Identifier: Apache-2.0
#include "slot.hpp"

#include <array>
#include <cstring>

#include "triskin/base/bytes.hpp"
#include "triskin/board/board.hpp"
#include "triskin/board/flash_map.hpp"
#include "triskin/board/registers/system.hpp"

namespace triskin::board {
namespace {

using namespace flash_map;

constexpr std::uint32_t kCommitMagic = 0x4D4D4F43;  // "COMM"
constexpr std::uint32_t kImageBytes = kSlotBytes - kPageBytes;
constexpr std::uint32_t kStartUnit = 2, kConfirmUnit = kStartUnit + kMaxStarts, kConfirmUnits = 3;
constexpr std::uint32_t kRamBase = 0x20000000, kRamEnd = 0x20020000;

std::uint32_t records(int slot) { return kSlots[slot] + kImageBytes; }
std::uint32_t word(std::uint32_t address) { return *reinterpret_cast<const volatile std::uint32_t*>(address); }
bool unit_used(std::uint32_t address) { return word(address) != 0xFFFFFFFF || word(address + 4) != 0xFFFFFFFF; }

// CRC of the commit record's first twelve bytes and the image: size and sequence are covered as well.
std::uint32_t slot_crc(int slot, std::uint32_t sequence, std::uint32_t size_bytes) {
  std::array<std::uint8_t, 12> head{};
  ByteWriter w(head);
  w.le32(kCommitMagic);
  w.le32(sequence);
  w.le32(size_bytes);
  return crc32({reinterpret_cast<const std::uint8_t*>(kSlots[slot]), size_bytes}, crc32(head));
}

bool vectors_fit(int slot, std::uint32_t size_bytes) {
  const std::uint32_t stack = word(kSlots[slot]), entry = word(kSlots[slot] + 4) & ~1U;
  return stack > kRamBase && stack <= kRamEnd && entry > kSlots[slot] && entry < kSlots[slot] + size_bytes;
}

bool marked(std::uint32_t first, std::uint32_t count) {
  for (std::uint32_t k = 0; k < count; ++k) {
    if (unit_used(first + k * kUnitBytes)) return true;
  }
  return false;
}

// The first free one of `count` units gets programmed; a unit that was torn looks free but is refused: the next one then.
bool add_mark(std::uint32_t first, std::uint32_t count) {
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t address = first + k * kUnitBytes;
    if (!unit_used(address) && program_flash_unit(address, 0, 0)) return true;
  }
  return false;
}

}  // namespace

SlotState inspect_slot(int slot) {
  SlotState s;
  const std::uint32_t at = records(slot);
  if (word(at) != kCommitMagic) return s;
  s.sequence = word(at + 4);
  s.size_bytes = word(at + 8);
  if (s.size_bytes < 512 || s.size_bytes > kImageBytes) return s;
  s.valid = vectors_fit(slot, s.size_bytes) && word(at + 12) == slot_crc(slot, s.sequence, s.size_bytes);
  for (std::uint32_t k = 0; k < kMaxStarts; ++k) s.starts += unit_used(at + (kStartUnit + k) * kUnitBytes) ? 1 : 0;
  s.confirmed = marked(at + kConfirmUnit * kUnitBytes, kConfirmUnits);
  return s;
}

int choose_slot() {
  int best = -1;
  std::uint32_t sequence = 0;
  for (int slot = 0; slot < 2; ++slot) {
    const SlotState s = inspect_slot(slot);
    if (!s.startable() || (best >= 0 && s.sequence <= sequence)) continue;
    best = slot;
    sequence = s.sequence;
  }
  return best;
}

bool note_start(int slot) { return add_mark(records(slot) + kStartUnit * kUnitBytes, kMaxStarts); }

Status erase_slot(int slot) {
  if (!erase_flash_page(records(slot))) return Status::kFlashFailed;
  for (std::uint32_t at = 0; at < kImageBytes; at += kPageBytes) {
    feed_watchdog();
    if (!erase_flash_page(kSlots[slot] + at)) return Status::kFlashFailed;
  }
  return Status::kOk;
}

Status commit_slot(int slot, std::uint32_t size_bytes, std::uint32_t crc) {
  if (size_bytes < 512 || size_bytes > kImageBytes) return Status::kOutOfRange;
  if (!vectors_fit(slot, size_bytes)) return Status::kWrongTarget;
  if (crc32({reinterpret_cast<const std::uint8_t*>(kSlots[slot]), size_bytes}) != crc) return Status::kBadCrc;
  const SlotState other = inspect_slot(1 - slot);
  const std::uint32_t sequence = other.valid ? other.sequence + 1 : 1;
  const std::uint32_t at = records(slot);
  // Magic and sequence first: the record counts only with the CRC of the second unit.
  if (!program_flash_unit(at, kCommitMagic, sequence)) return Status::kFlashFailed;
  if (!program_flash_unit(at + 8, size_bytes, slot_crc(slot, sequence, size_bytes))) return Status::kFlashFailed;
  return inspect_slot(slot).valid ? Status::kOk : Status::kFlashFailed;
}

void confirm_running_slot() {
  const std::uint32_t vectors = core_reg::kVtor.read();
  for (int slot = 0; slot < 2; ++slot) {
    const std::uint32_t first = records(slot) + kConfirmUnit * kUnitBytes;
    // No CRC here: it would hold up the loop for 6 ms, and the loader has just looked.
    if (vectors == kSlots[slot] && !marked(first, kConfirmUnits)) (void)add_mark(first, kConfirmUnits);
  }
}

}  // namespace triskin::board
