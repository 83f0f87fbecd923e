// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/core/bytes.hpp"
#include "triskin/core/status.hpp"
#include "triskin/ports/ports.hpp"

namespace triskin::boot {

inline constexpr int kMaxStarts = 3;  ///< An application that does not confirm itself may be started this often.

struct SlotState {
  bool valid = false;      ///< The slot is committed, its CRC is right, and its vectors point into the slot.
  bool confirmed = false;  ///< The application has run and confirmed that it works.
  int starts = 0;
  std::uint32_t sequence = 0, size_bytes = 0;
  std::uint32_t record_crc = 0;  ///< The commit record contains this slot_crc().
  /// Returns true if the slot may be started before the other one: it is valid, and confirmed or tried fewer than
  /// kMaxStarts times.
  [[nodiscard]] bool startable() const { return valid && (confirmed || starts < kMaxStarts); }
};

/// Makes the result of Restart::image_state(). `slot` is 0 or 1.
[[nodiscard]] inline wire::ImageState image_state_of(int slot, const SlotState& state) {
  return {static_cast<std::uint8_t>(slot), state.confirmed, state.sequence, state.size_bytes, state.record_crc};
}

/// Each of the two application slots ends with a page of records that are only ever appended (docs/flash_layout.md):
/// commit (sequence, size, CRC), up to three starts, confirmation. The page must be larger than 1,024 bytes. A power
/// failure leaves the slot in its old or its new state.
class SlotStore {
 public:
  /// `origins` are the addresses at which the flash of each slot appears, for which its image is linked.
  constexpr SlotStore(std::array<fw::FlashArea*, 2> slots, std::array<std::uint32_t, 2> origins)
      : slots_(slots), origins_(origins) {}

  /// Reads the state of a slot. Cost: one CRC over the image.
  [[nodiscard]] SlotState inspect(int slot) const;
  /// Reads sequence and marks of a slot without its CRC, for a slot that is known to be valid.
  [[nodiscard]] SlotState peek(int slot) const;
  /// Returns the slot to start: the newest startable one, or else the newest valid one, because three power failures
  /// must not strand a board whose only image was never confirmed. −1 means that none is valid.
  [[nodiscard]] int choose() const;
  /// Call it before an unconfirmed application starts. Returns false if all records are used, or the flash refused.
  bool note_start(int slot);
  /// Erases the records first, so that the slot is invalid from the first moment.
  [[nodiscard]] Status erase(int slot);
  /// Programs one unit of the image. Errors: kNoSpace, kFlashFailed.
  [[nodiscard]] Status program(int slot, std::uint32_t offset, Bytes unit);
  /// Asks layout::check_image() about what was written into a slot; loader and DFU know no running version.
  [[nodiscard]] Status check(int slot, std::uint32_t size_bytes, std::uint32_t running_version = 0,
                             bool may_be_older = false) const;
  /// Writes the commit record after checking the contents of the flash. Errors: those of check(), kBadCrc,
  /// kFlashFailed.
  [[nodiscard]] Status commit(int slot, std::uint32_t size_bytes, std::uint32_t crc);
  /// Erases one page of a slot. This and the following functions are the parts of erase() and commit(), for an update
  /// while the application works.
  [[nodiscard]] bool erase_page(int slot, std::size_t offset) { return area(slot).erase_page(offset); }
  /// Returns the first byte of the page of records, from the start of a slot.
  [[nodiscard]] std::size_t records(int slot) const { return area(slot).size_bytes() - area(slot).page_bytes(); }
  /// Returns the address that the images of a slot are linked for.
  [[nodiscard]] std::uint32_t origin(int slot) const { return origins_[static_cast<std::size_t>(slot)]; }
  [[nodiscard]] std::size_t page_bytes() const { return area(0).page_bytes(); }
  /// Returns the present contents of a slot; the view is valid as long as the store.
  [[nodiscard]] Bytes bytes(int slot) const { return area(slot).bytes(); }
  /// Returns true when stack and entry of the image in a slot allow it to start there.
  [[nodiscard]] bool vectors_fit(int slot, std::uint32_t size_bytes) const;
  /// Writes the commit record with this slot_crc(). Returns false if the flash refused.
  [[nodiscard]] bool write_record(int slot, std::uint32_t sequence, std::uint32_t size_bytes, std::uint32_t crc);
  /// Notes that the application in a slot works. Does nothing when this was noted before.
  void confirm(int slot);

 private:
  [[nodiscard]] fw::FlashArea& area(int slot) const { return *slots_[static_cast<std::size_t>(slot)]; }
  [[nodiscard]] std::uint32_t word(int slot, std::size_t at) const {
    return ByteReader(area(slot).bytes().subspan(at, 4)).le32();
  }
  [[nodiscard]] bool unit_erased(int slot, std::size_t at) const {
    return word(slot, at) == 0xFFFFFFFF && word(slot, at + 4) == 0xFFFFFFFF;
  }
  [[nodiscard]] int marks(int slot, std::size_t first, std::size_t count) const;
  bool add_mark(int slot, std::size_t first, std::size_t count);

  std::array<fw::FlashArea*, 2> slots_;
  std::array<std::uint32_t, 2> origins_;
};

}  // namespace triskin::boot
