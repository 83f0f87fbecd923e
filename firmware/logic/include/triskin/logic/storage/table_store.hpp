// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/layout/patch_image.hpp"
#include "triskin/ports/ports.hpp"

namespace triskin::fw {

/// The board's flash has two slots for the patch image and two pages for the node address. The image of a slot is valid
/// only if its commit record, written last, has its length and CRC, so a power failure at any moment leaves the old or
/// the new image. The calibration of its modules follows the image in the slot and is protected likewise. Layout:
/// docs/flash_layout.md. Pages 0 and 1: slots; 2 and 3: node address.
class TableStore {
 public:
  /// Stores tables and node address in `flash`, which must outlive it; load() reads them.
  explicit TableStore(FlashArea& flash) : flash_(flash) {}

  /// Finds the newest valid slot. Call it once after power-up.
  void load();

  /// Returns true when a table is active.
  [[nodiscard]] bool has_table() const { return active_slot_ >= 0; }
  /// Returns the active table; call it only if has_table().
  [[nodiscard]] const layout::PatchImage& table() const { return table_; }
  /// Returns the image of the active table as flashed; empty if there is none.
  [[nodiscard]] Bytes active_bytes() const;
  /// Returns the sequence number of the active slot. It counts activations, and calibrations for which the page was
  /// full.
  [[nodiscard]] std::uint32_t sequence() const { return sequence_; }
  /// Returns kEmpty before the first activation.
  [[nodiscard]] Status status() const { return has_table() ? Status::kOk : Status::kEmpty; }

  /// Prepares to receive an image for the inactive slot into RAM; nothing touches the flash before activate().
  void begin_download(std::size_t size_bytes);
  /// Appends the next bytes of the download. Returns kOk, or kNoSpace if there are more than announced.
  [[nodiscard]] Status append(Bytes block);
  /// Returns true when as many bytes arrived as begin_download() announced.
  [[nodiscard]] bool downloaded() const { return staged_size_ > 0 && staged_at_ == staged_size_; }
  /// Returns the bytes of the image that arrived so far.
  [[nodiscard]] Bytes staged_bytes() const { return {staged_.data(), staged_at_}; }
  /// Decodes the received image and checks that it is for this node. kBadLength when it is incomplete.
  [[nodiscard]] Status check_staged(std::uint8_t node_address) const;
  /// Writes the staged image to the inactive slot, reads it back, commits it, and makes it active. The calibration is
  /// copied when the new table has the same design id and the same modules at the same places; otherwise it is lost
  /// with the old table. Errors: those of check_staged(), kFlashFailed; the old table then stays active.
  [[nodiscard]] Status activate(std::uint8_t node_address);

  /// Returns the calibration of the active table as it was written (wire::Calibration), or nothing. The view is valid
  /// until the next write.
  [[nodiscard]] Bytes calibration() const;
  /// Stores a wire::Calibration with the active table in place of the previous one; one without rows deletes it. An
  /// equal calibration is not written again. Returns kOk; the errors of Calibration::decode; kEmpty: no table;
  /// kWrongTarget: of another design, or of a place without a module; kFlashFailed: the old one stays. Takes 5 ms, or
  /// 30 ms when a page is erased.
  [[nodiscard]] Status set_calibration(Bytes value);

  /// Returns the node address, layout::kFirstNode … kLastNode; kFirstNode when it was never assigned.
  [[nodiscard]] std::uint8_t node_address() const { return node_address_; }
  /// Writes the node address to flash. Returns kOk; kOutOfRange: not 1 … 126; kFlashFailed.
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
  std::uint16_t node_sequence_ = 0;  ///< The number allows at most 65535 changes.
  int node_page_ = 0;
  std::array<std::uint8_t, layout::kMaxImageBytes> staged_{};
  std::size_t staged_size_ = 0, staged_at_ = 0;
  // The calibration is at this position in the page of the active slot; 0 bytes means that there is none.
  std::size_t calibration_at_ = 0, calibration_bytes_ = 0;
  std::size_t free_at_ = 0;  // The first free byte of that page follows its records.
};

}  // namespace triskin::fw
