// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/base/bytes.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/logic/table_row.hpp"
#include "triskin/ports/ports.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::fw {

/// Diagnostic trouble codes of the modules: 3 bytes, 0x9 then the module's state in the low nibble; 0; row in the
/// table. A fault that came and went stays confirmed until it is cleared, over a loss of power too. With each goes what
/// was at its first occurrence. Kept in flash as a log on two pages that are filled in turn (docs/flash_layout.md); a
/// cut of power loses at most the last entry. A fault is written once until it is cleared, so that a loose contact does
/// not wear the flash.
class FaultMemory {
 public:
  static constexpr std::uint8_t kTestFailed = 0x01, kConfirmed = 0x08;
  static constexpr std::size_t kFirstPage = 4;  ///< and the next one; a smaller flash keeps nothing
  static constexpr std::size_t kRecordBytes = 16;

  /// State of affairs at the first occurrence.
  struct Freeze {
    std::uint32_t time_ms = 0;  ///< since power-up
    std::uint32_t sample = 0;
    bool operator==(const Freeze&) const = default;
  };

  explicit FaultMemory(FlashArea& flash) : flash_(flash) {}
  /// Reads what was confirmed before. Call once after power-up.
  void load();
  /// Notes the present state of a module; its earlier faults stay confirmed.
  void note(TableRow row, wire::ModuleState state, Freeze now);
  /// Forgets all faults. False: the flash refused.
  bool clear();
  /// DTC and status of every entry that has one of the bits of `mask`.
  void report(std::uint8_t mask, ByteWriter& out) const;
  /// Status and freeze data of one DTC. False: no such entry.
  [[nodiscard]] bool snapshot(std::uint32_t dtc, std::uint8_t& status, Freeze& freeze) const;

 private:
  static constexpr std::size_t kStates = 9;  // of ModuleState; 0 and 1 are no faults
  static constexpr std::size_t kFirstFault = 2;
  struct Entry {
    std::uint8_t status = 0;
    Freeze freeze;
  };

  [[nodiscard]] bool stored() const { return flash_.size_bytes() >= (kFirstPage + 2) * flash_.page_bytes(); }
  [[nodiscard]] std::size_t page_offset(std::size_t page) const { return (kFirstPage + page) * flash_.page_bytes(); }
  [[nodiscard]] Bytes record_at(std::size_t page, std::size_t index) const;
  [[nodiscard]] bool page_valid(std::size_t page, std::uint32_t& sequence) const;
  [[nodiscard]] bool program(std::size_t page, std::size_t index, std::span<const std::uint8_t, kRecordBytes> record);
  void replay(std::size_t page);
  bool append(TableRow row, std::size_t state);
  bool start_page();

  FlashArea& flash_;
  std::array<std::array<Entry, kStates>, layout::kMaxModules> entries_{};
  std::size_t page_ = 0, used_ = 0;  // used_ records of page_; 0: no page is started
  std::uint32_t sequence_ = 0;
};

}  // namespace triskin::fw
