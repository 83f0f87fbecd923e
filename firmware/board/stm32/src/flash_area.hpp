// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/boot/slot_store.hpp"
#include "triskin/ports/ports.hpp"

namespace triskin::board {

/// An area is a part of the flash in the address space. It feeds the watchdog before each erase.
class Stm32FlashArea final : public fw::FlashArea {
 public:
  constexpr Stm32FlashArea(std::uint32_t base, std::size_t size_bytes) : base_(base), size_bytes_(size_bytes) {}
  [[nodiscard]] std::size_t size_bytes() const override { return size_bytes_; }
  [[nodiscard]] std::size_t page_bytes() const override;
  [[nodiscard]] std::size_t program_bytes() const override;
  [[nodiscard]] bool erase_page(std::size_t offset) override;
  [[nodiscard]] bool program(std::size_t offset, Bytes bytes) override;
  [[nodiscard]] Bytes bytes() const override;

 private:
  std::uint32_t base_;
  std::size_t size_bytes_;
};

extern Stm32FlashArea table_flash;
extern boot::SlotStore application_slots;
/// Returns the slot of the running application, or −1 in the loader.
[[nodiscard]] int running_slot();

}  // namespace triskin::board
