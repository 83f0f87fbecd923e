// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/core/bytes.hpp"
#include "triskin/core/status.hpp"
#include "triskin/ports/ports.hpp"

namespace triskin::boot {

inline constexpr int kMaxStarts = 3;  ///< starts allowed to an application that does not confirm itself

struct SlotState {
  bool valid = false;      ///< committed, CRC right, vectors point into the slot
  bool confirmed = false;  ///< the application ran and said so
  int starts = 0;
  std::uint32_t sequence = 0, size_bytes = 0;
  std::uint32_t record_crc = 0;  ///< slot_crc() of what was committed
  /// True if it comes before the other slot: valid, and confirmed or tried fewer than kMaxStarts times.
  [[nodiscard]] bool startable() const { return valid && (confirmed || starts < kMaxStarts); }
};

/// Result for Restart::image_state(). `slot`: 0 or 1.
[[nodiscard]] inline wire::ImageState image_state_of(int slot, const SlotState& state) {
  return {static_cast<std::uint8_t>(slot), state.confirmed, state.sequence, state.size_bytes, state.record_crc};
}

/// The two application slots. Each ends with a page of records that are only ever added to (docs/firmware_board.md):
/// commit (sequence, size, CRC), up to three starts, confirmation. A power cut leaves the slot in its old or its new
/// state.
class SlotStore {
 public:
  /// `origins`: where the flash of each slot stands in the address space, for which its image is linked.
  constexpr SlotStore(std::array<fw::FlashArea*, 2> slots, std::array<std::uint32_t, 2> origins)
      : slots_(slots), origins_(origins) {}

  /// Cost: one CRC over the image.
  [[nodiscard]] SlotState inspect(int slot) const;
  /// Sequence and marks of a slot, without its CRC: for one that is known to be valid.
  [[nodiscard]] SlotState peek(int slot) const;
  /// The slot to start: the newest startable one; without any the newest valid one, for a board whose only image was
  /// never confirmed must not be stranded by three power cuts. -1: none is valid.
  [[nodiscard]] int choose() const;
  /// Call it before an unconfirmed application starts. False: all records are used, or the flash refused.
  bool note_start(int slot);
  /// Erases the records first, so that the slot does not count from the first moment.
  [[nodiscard]] Status erase(int slot);
  /// One unit of the image. kNoSpace, kFlashFailed.
  [[nodiscard]] Status program(int slot, std::uint32_t offset, Bytes unit);
  /// Writes the commit record after looking at what the flash holds. kOutOfRange, kWrongTarget (vectors), kBadCrc,
  /// kFlashFailed.
  [[nodiscard]] Status commit(int slot, std::uint32_t size_bytes, std::uint32_t crc);
  /// The parts of erase() and commit(), for an update beside the work of the application. Erases one page of a slot.
  [[nodiscard]] bool erase_page(int slot, std::size_t offset) { return area(slot).erase_page(offset); }
  /// First byte of the page of records, from the start of a slot.
  [[nodiscard]] std::size_t records(int slot) const { return area(slot).size_bytes() - area(slot).page_bytes(); }
  /// Address that the images of a slot are linked for.
  [[nodiscard]] std::uint32_t origin(int slot) const { return origins_[static_cast<std::size_t>(slot)]; }
  [[nodiscard]] std::size_t page_bytes() const { return area(0).page_bytes(); }
  /// What the flash of a slot holds now; valid as long as the store.
  [[nodiscard]] Bytes bytes(int slot) const { return area(slot).bytes(); }
  /// True when the stack and the entry of the image in a slot are such that it can start there.
  [[nodiscard]] bool vectors_fit(int slot, std::uint32_t size_bytes) const;
  /// Writes the commit record with this slot_crc(). False: the flash refused.
  [[nodiscard]] bool write_record(int slot, std::uint32_t sequence, std::uint32_t size_bytes, std::uint32_t crc);
  /// The application that runs from a slot says that it works. Does nothing when it has done so before.
  void confirm(int slot);

 private:
  [[nodiscard]] fw::FlashArea& area(int slot) const { return *slots_[static_cast<std::size_t>(slot)]; }
  [[nodiscard]] std::uint32_t word(int slot, std::size_t at) const {
    return ByteReader(area(slot).bytes().subspan(at, 4)).le32();
  }
  [[nodiscard]] bool unit_used(int slot, std::size_t at) const {
    return word(slot, at) != 0xFFFFFFFF || word(slot, at + 4) != 0xFFFFFFFF;
  }
  [[nodiscard]] bool marked(int slot, std::size_t first, std::size_t count) const;
  bool add_mark(int slot, std::size_t first, std::size_t count);

  std::array<fw::FlashArea*, 2> slots_;
  std::array<std::uint32_t, 2> origins_;
};

}  // namespace triskin::boot
