// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "triskin/core/bytes.hpp"
#include "triskin/layout/flash_pages.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/logic/sampling/table_row.hpp"
#include "triskin/ports/ports.hpp"
#include "triskin/wire/faults.hpp"
#include "triskin/wire/health.hpp"

namespace triskin::fw {

/// The memory keeps the diagnostic trouble codes of the modules (wire::FaultCode). A fault that has gone stays
/// confirmed until it is cleared, even over a loss of power, together with the circumstances of its first occurrence.
/// The flash stores a log on two pages that are filled in turn (docs/flash_layout.md); a power failure loses at most
/// the last entry. A fault is written only once until it is cleared, so that a loose contact does not wear the flash.
/// The last crash of the controller is stored beside the faults, in separate records.
class FaultMemory {
 public:
  static constexpr std::size_t kFirstPage =
      layout::kFirstFaultPage;  ///< It uses this page and the next one; a smaller flash stores nothing.
  static constexpr std::size_t kRecordBytes = 16;

  using Freeze = wire::Freeze;

  /// Stores its log in `flash`, which must outlive it; load() reads it.
  explicit FaultMemory(FlashArea& flash) : flash_(flash) {}
  /// Reads the earlier confirmed faults. Call it once after power-up.
  void load();
  /// Records the present state of a module; its earlier faults stay confirmed.
  void note(TableRow row, wire::ModuleState state, Freeze now);
  /// Stores a crash in place of the previous one. Returns false if the flash refused; the crash then stays in RAM.
  bool note_crash(const wire::Crash& crash);
  /// Returns the last crash that was stored; empty if there was none since the memory was cleared.
  [[nodiscard]] const std::optional<wire::Crash>& crash() const { return crash_; }
  /// Deletes all faults and the crash. Returns false if the flash refused.
  bool clear();
  /// Deletes the faults of the modules, because their rows mean other modules with a new table. Returns false if the
  /// flash refused.
  bool clear_modules();
  /// Appends DTC and status of every entry that has one of the bits of `mask`.
  void report(std::uint8_t mask, ByteWriter& out) const;
  /// Returns status and freeze data of one DTC; empty if there is no such entry.
  [[nodiscard]] std::optional<wire::FreezeFrame> snapshot(std::uint32_t dtc) const;

 private:
  static constexpr std::uint8_t kTestFailed = wire::fault_status::kFailsNow,
                                kConfirmed = wire::fault_status::kConfirmed;
  static constexpr std::size_t kCrashPartBytes = 10;  // The size excludes mark, number and CRC of a record.
  static constexpr std::size_t kCrashRecords = (wire::Crash::kMaxBytes + kCrashPartBytes - 1) / kCrashPartBytes;
  static constexpr std::size_t kStates = wire::kModuleStateCount;
  static constexpr auto kFirstFault = static_cast<std::size_t>(wire::kFirstFaultState);
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
  void replay_fault(Bytes record);
  void replay_crash(Bytes record);
  [[nodiscard]] bool program_crash(std::size_t page, std::size_t index);
  bool append(TableRow row, std::size_t state);
  bool start_page();

  FlashArea& flash_;
  std::array<std::array<Entry, kStates>, layout::kMaxModules> entries_{};
  std::optional<wire::Crash> crash_;
  std::array<std::uint8_t, kCrashRecords * kCrashPartBytes> crash_parts_{};  // The parts were read by replay() so far.
  std::size_t crash_part_ = 0;                                               // The next record must have this part.
  std::size_t page_ = 0, used_ = 0;  // This many records are used on page_; 0 means that no page was started.
  std::uint32_t sequence_ = 0;
};

}  // namespace triskin::fw
