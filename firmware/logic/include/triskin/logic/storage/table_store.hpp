// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/layout/patch_image.hpp"
#include "triskin/ports/ports.hpp"

namespace triskin::fw {

/// Two slots for the patch image and two pages for the node address, on the board's flash. The image of a slot counts
/// only when its commit record, written last, names its length and CRC: a cut of power at any moment leaves the old or
/// the new one. Behind the image its slot keeps the calibration of its modules, likewise. Layout:
/// docs/flash_layout.md. Pages 0 and 1: slots; 2 and 3: node address.
class TableStore {
 public:
  /// Keeps tables and node address in `flash`, which must outlive it; load() reads them.
  explicit TableStore(FlashArea& flash) : flash_(flash) {}

  /// Finds the newest valid slot. Call once after power-up.
  void load();

  /// True when a table is active.
  [[nodiscard]] bool has_table() const { return active_slot_ >= 0; }
  /// The active table; only with has_table().
  [[nodiscard]] const layout::PatchImage& table() const { return table_; }
  /// Image of the active table as flashed; empty without one.
  [[nodiscard]] Bytes active_bytes() const;
  /// Sequence number of the active slot; it counts activations, and calibrations that found its page full.
  [[nodiscard]] std::uint32_t sequence() const { return sequence_; }
  /// kEmpty before the first activation.
  [[nodiscard]] Status status() const { return has_table() ? Status::kOk : Status::kEmpty; }

  /// Receives an image for the inactive slot into RAM; nothing touches flash before activate().
  void begin_download(std::size_t size_bytes);
  /// Takes the next bytes of the download. kOk; kNoSpace: more than were announced.
  [[nodiscard]] Status append(Bytes block);
  /// True when as many bytes came as begin_download() announced.
  [[nodiscard]] bool downloaded() const { return staged_size_ > 0 && staged_at_ == staged_size_; }
  /// Bytes of the image that came so far.
  [[nodiscard]] Bytes staged_bytes() const { return {staged_.data(), staged_at_}; }
  /// Decodes what was received and checks that it is for this node. kBadLength when not complete.
  [[nodiscard]] Status check_staged(std::uint8_t node_address) const;
  /// Writes the staged image to the inactive slot, reads it back, commits it, and makes it active. The calibration goes
  /// along when the new table has the same design id and the same modules at the same places, else it ends with the old
  /// table. Errors: those of check_staged(), kFlashFailed; the old table then stays active.
  [[nodiscard]] Status activate(std::uint8_t node_address);

  /// The calibration of the active table as it was written (wire::Calibration); empty: none. Valid until the next
  /// write.
  [[nodiscard]] Bytes calibration() const;
  /// Keeps a wire::Calibration with the active table, in place of the one before; one without rows deletes it. What is
  /// kept already is not written again. kOk; those of Calibration::decode; kEmpty: no table; kWrongTarget: of another
  /// design, or of a place without a module; kFlashFailed: the old one stays. Takes 5 ms, 30 ms when a page is erased.
  [[nodiscard]] Status set_calibration(Bytes value);

  /// layout::kFirstNode … kLastNode; kFirstNode when never assigned.
  [[nodiscard]] std::uint8_t node_address() const { return node_address_; }
  /// Writes the node address to flash. kOk; kOutOfRange: not 1 … 126; kFlashFailed.
  [[nodiscard]] Status set_node_address(std::uint8_t address);

 private:
  static constexpr std::size_t kCommitBytes = 16;
  [[nodiscard]] std::size_t slot_offset(int slot) const { return static_cast<std::size_t>(slot) * flash_.page_bytes(); }
  [[nodiscard]] Result<std::uint32_t> read_slot(int slot, layout::PatchImage& image) const;
  void load_node_address();
  [[nodiscard]] Status write_slot(Bytes image, Bytes calibration);
  bool program(std::size_t offset, Bytes bytes);
  bool write_record(std::size_t offset, Bytes calibration);
  void find_calibration();

  FlashArea& flash_;
  int active_slot_ = -1;
  std::uint32_t sequence_ = 0;
  layout::PatchImage table_;
  std::uint8_t node_address_ = layout::kFirstNode;
  std::uint16_t node_sequence_ = 0;  ///< 65535 changes at most
  int node_page_ = 0;
  std::array<std::uint8_t, layout::kMaxImageBytes> staged_{};
  std::size_t staged_size_ = 0, staged_at_ = 0;
  std::size_t calibration_at_ = 0, calibration_bytes_ = 0;  // Position in the page of the active slot; 0 bytes: none.
  std::size_t free_at_ = 0;                                 // First free byte after the records of that page.
};

}  // namespace triskin::fw
