// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "triskin/core/bytes.hpp"
#include "triskin/drivers/ad7147.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/ports/ports.hpp"
#include "triskin/wire/offsets.hpp"

namespace triskin::fw {

/// The offsets belong to the chip at one place. A place is a line and an address, because the chip itself can only be
/// recognized by the kind and revision in its device id.
struct PlaceOffsets {
  bool known = false;           ///< The steps were right at least once.
  std::uint16_t device_id = 0;  ///< They were found for a chip with this id.
  ad7147::Offsets steps{};      ///< Each step is 0 … ad7147::kMaxOffset.
  bool to_store = false;        ///< The offsets are newer than those in the flash.
  wire::OffsetState state = wire::OffsetState::kNone;
  wire::Latching latching = wire::Latching::kUnknown;
  std::uint16_t outside = 0;   ///< Bit t says that taxel t rests outside the middle third.
  ad7147::Results rest{};      ///< as wire::SettledRest; 0 until the offsets are settled
  std::uint32_t searches = 0;  ///< Completed searches are counted from power-up.
};
/// The index is the place: kAddressesPerLine · line + address.
using OffsetBook = std::array<PlaceOffsets, layout::kMaxModules>;

/// Stores the offsets in flash as a log of records on two pages that are filled in turn (docs/flash_layout.md). The
/// newest record of a place counts; before a page is erased, its valid records are copied to the other one. A power
/// failure loses at most the record that was being written. One step() writes one unit, so that no reading is late.
class OffsetStore {
 public:
  /// The store uses this page and the next one; a smaller flash stores nothing.
  static constexpr std::size_t kFirstPage = 6;
  static constexpr std::size_t kRecordBytes = 32;
  static constexpr std::uint8_t kVersion = 1;  ///< Records of another version are ignored.

  /// Stores its log in `flash`, which must outlive it; load() reads it.
  explicit OffsetStore(FlashArea& flash) : flash_(flash) {}
  /// Fills `book` with the contents of the flash. Call it once after power-up.
  void load(OffsetBook& book);
  /// Writes a unit of offsets that are newer in `book` than in the flash, or erases a page. Returns true if it did so,
  /// and more may have to be written.
  bool step(OffsetBook& book);

 private:
  using Record = std::array<std::uint8_t, kRecordBytes>;
  static constexpr std::size_t kNoPlace = layout::kMaxModules;

  [[nodiscard]] bool stored() const { return flash_.size_bytes() >= (kFirstPage + 2) * flash_.page_bytes(); }
  [[nodiscard]] std::size_t slots() const { return flash_.page_bytes() / kRecordBytes; }
  [[nodiscard]] std::size_t offset_of(std::size_t page, std::size_t slot) const {
    return (kFirstPage + page) * flash_.page_bytes() + slot * kRecordBytes;
  }
  void read(std::size_t page, std::size_t slot, OffsetBook& book);
  void find_end();
  [[nodiscard]] std::size_t next_place(const OffsetBook& book) const;
  void begin_record(OffsetBook& book, std::size_t place);
  void start_page();
  void write_unit(OffsetBook& book);

  FlashArea& flash_;
  std::size_t page_ = 0, used_ = 0;  // The first used_ slots of page_ hold records.
  std::uint32_t sequence_ = 0;       // The newest record has this number.
  // Each place has the number of its valid record; 0 means that there is none.
  std::array<std::uint32_t, layout::kMaxModules> newest_{};
  std::uint16_t elsewhere_ = 0;  // Bit p says that the valid record of place p is on the other page.
  std::size_t writing_ = kNoPlace, written_ = 0;
  Record record_{};
  bool failed_ = false;  // The flash refused a write, so nothing more is written until load().
};

}  // namespace triskin::fw
