// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>

namespace triskin::sim {

/// Thrown out of a flash operation when power is lost in the middle of it: the virtual controller is then dead and must
/// be made anew on the same flash. Only simulation throws; the firmware never sees or catches it.
struct PowerLost : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What the flash of the STM32G474 takes (DS12288, typical) to erase a page of 2 KB and to program a unit of 8 bytes.
/// It does one thing at a time.
inline constexpr std::uint64_t kPageErase_ns = 22'020'000, kUnitProgram_ns = 81'690;

/// Flash memory that obeys the rules of the STM32G474 (RM0440 §3): erased bytes read 0xFF, pages of `page_bytes`,
/// programming in aligned units of `program_bytes` into erased units only (a unit written twice is refused: ECC).
class FlashModel {
 public:
  virtual ~FlashModel() = default;
  /// Bytes of the area; a multiple of page_bytes().
  [[nodiscard]] virtual std::size_t size_bytes() const = 0;
  /// Bytes that one erase_page() erases.
  [[nodiscard]] virtual std::size_t page_bytes() const = 0;  ///< The STM32G474 has pages of 2,048 bytes.
  /// Bytes of one unit that program() writes.
  [[nodiscard]] virtual std::size_t program_bytes() const = 0;  ///< The STM32G474 programs eight bytes at a time.
  /// It returns false for a page that is misaligned or out of range.
  virtual bool erase_page(std::size_t offset_bytes) = 0;
  /// It returns false where the flash would refuse the write.
  virtual bool program(std::size_t offset_bytes, std::span<const std::uint8_t> bytes) = 0;
  /// The whole area as it reads now; erased bytes read 0xFF.
  [[nodiscard]] virtual std::span<const std::uint8_t> bytes() const = 0;
};

}  // namespace triskin::sim
