// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/base/status.hpp"

/// The two application slots. Each ends with a page of records that are only ever added to (docs/firmware_board.md):
/// commit (sequence, size, CRC), up to three starts, confirmation. A cut of power leaves the slot as it was or as it shall be.
namespace triskin::board {

inline constexpr int kMaxStarts = 3;  ///< of an application that does not confirm itself

struct SlotState {
  bool valid = false;      ///< committed, CRC right, vectors point into the slot
  bool confirmed = false;  ///< the application ran and said so
  int starts = 0;
  std::uint32_t sequence = 0, size_bytes = 0;
  [[nodiscard]] bool startable() const { return valid && (confirmed || starts < kMaxStarts); }
};

[[nodiscard]] SlotState inspect_slot(int slot);
/// The newest startable slot; -1 when there is none. Cost: one CRC over both images.
[[nodiscard]] int choose_slot();
/// Before an unconfirmed application starts. False: no record could be written.
bool note_start(int slot);
/// Erases the records first, so that the slot does not count from the first moment.
[[nodiscard]] Status erase_slot(int slot);
/// Writes the commit record after looking at what the flash holds. kOutOfRange, kWrongTarget (vectors), kBadCrc, kFlashFailed.
[[nodiscard]] Status commit_slot(int slot, std::uint32_t size_bytes, std::uint32_t crc);
/// The application that runs from a slot says that it works. Does nothing when it has done so before.
void confirm_running_slot();

}  // namespace triskin::board
