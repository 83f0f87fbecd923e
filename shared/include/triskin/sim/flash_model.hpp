// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>

namespace triskin::sim {

/// Thrown from a flash operation when the power fails in the middle of it. The virtual controller is then dead and must
/// be constructed again on the same flash. Only the simulation throws it; the firmware never sees or catches it.
struct PowerLost : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The STM32G474 (DS12288) typically takes these times to erase a page of 2 KB and to program a unit of 8 bytes. The
/// flash performs one operation at a time.
inline constexpr std::uint64_t kPageErase_ns = 22'020'000, kUnitProgram_ns = 81'690;

/// The model obeys the rules of the STM32G474 (RM0440 §3): erased bytes read 0xFF, `page_bytes` are erased at once,
/// and `program_bytes` are programmed at once, aligned and only into an erased unit (the ECC forbids writing a unit
/// twice).
class FlashModel {
 public:
  virtual ~FlashModel() = default;
  /// Returns the size of the area, a multiple of page_bytes().
  [[nodiscard]] virtual std::size_t size_bytes() const = 0;
  /// Returns how many bytes erase_page() erases.
  [[nodiscard]] virtual std::size_t page_bytes() const = 0;  ///< The STM32G474 has pages of 2,048 bytes.
  /// Returns how many bytes program() writes at once.
  [[nodiscard]] virtual std::size_t program_bytes() const = 0;  ///< The STM32G474 programs eight bytes at a time.
  /// Erases one page; returns false for an offset that is misaligned or out of range.
  virtual bool erase_page(std::size_t offset_bytes) = 0;
  /// Programs whole units; returns false where the flash would refuse the write.
  virtual bool program(std::size_t offset_bytes, std::span<const std::uint8_t> bytes) = 0;
  /// Returns the whole area as it reads now; erased bytes read 0xFF.
  [[nodiscard]] virtual std::span<const std::uint8_t> bytes() const = 0;
};

}  // namespace triskin::sim
