// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>

#include "triskin/machine/flash_chip.hpp"
#include "triskin/sim/flash_model.hpp"

namespace triskin::machine {

/// Shows the pages of tables and fault memory of a flash chip as board/posix sees them.
class TablesFlash final : public sim::FlashModel {
 public:
  static constexpr std::uint32_t kBase = 0x0807C000, kBytes = 0x4000;
  explicit TablesFlash(FlashChip& chip) : chip_(chip) {}
  [[nodiscard]] std::size_t size_bytes() const override { return kBytes; }
  [[nodiscard]] std::size_t page_bytes() const override { return FlashChip::kPage; }
  [[nodiscard]] std::size_t program_bytes() const override { return FlashChip::kUnit; }
  bool erase_page(std::size_t offset) override {
    if (offset % FlashChip::kPage != 0 || offset >= kBytes) return false;
    std::fill_n(begin() + static_cast<std::ptrdiff_t>(offset), FlashChip::kPage, std::uint8_t{0xFF});
    std::fill_n(chip_.used.begin() + static_cast<std::ptrdiff_t>((kOffset + offset) / FlashChip::kUnit),
                FlashChip::kPage / FlashChip::kUnit, false);
    ++chip_.operations;
    return true;
  }
  bool program(std::size_t offset, std::span<const std::uint8_t> bytes) override {
    if (offset % FlashChip::kUnit != 0 || bytes.size() % FlashChip::kUnit != 0 || offset + bytes.size() > kBytes)
      return false;
    for (std::size_t k = 0; k < bytes.size(); k += FlashChip::kUnit) {
      const std::size_t unit = (kOffset + offset + k) / FlashChip::kUnit;
      if (chip_.used[unit]) return false;
      chip_.used[unit] = true;
      std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(k), FlashChip::kUnit,
                  begin() + static_cast<std::ptrdiff_t>(offset + k));
      ++chip_.operations;
    }
    return true;
  }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const override { return {chip_.bytes.data() + kOffset, kBytes}; }

 private:
  static constexpr std::size_t kOffset = kBase - FlashChip::kBase;
  std::vector<std::uint8_t>::iterator begin() { return chip_.bytes.begin() + static_cast<std::ptrdiff_t>(kOffset); }
  FlashChip& chip_;
};

}  // namespace triskin::machine
