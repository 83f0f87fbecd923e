// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace triskin::machine {

/// Holds the content of an ELF file: bytes by load address, values of symbols.
struct ElfImage {
  std::map<std::uint32_t, std::vector<std::uint8_t>> segments;  ///< Only segments with bytes in the file are listed.
  std::map<std::string, std::uint32_t> symbols;
  /// Joins all segments to one run of bytes from the lowest to the highest load address; gaps are 0xFF.
  [[nodiscard]] std::vector<std::uint8_t> flat() const;
  /// Returns the lowest load address of a segment. The image must have one.
  [[nodiscard]] std::uint32_t origin() const { return segments.begin()->first; }
};
/// Throws InputError naming the file when it is no 32-bit ARM ELF.
[[nodiscard]] ElfImage read_elf(const std::filesystem::path& path);

/// Describes one operation of the silicon on its cells: erasing a page, or programming a unit.
struct FlashOperation {
  bool erase = false;
  std::uint32_t index = 0;  ///< The index is that of the page, or of the unit.
  std::uint64_t value = 0;  ///< The unit has this value afterwards.
};

/// What a programmer writes besides the bytes of the file: most write whole blocks and fill them up.
struct Filling {
  std::uint32_t block_bytes = 0;  ///< 0: nothing. Flash algorithms of the STM32G4 and L4 have blocks of 1,024 bytes.
  std::uint8_t value = 0xFF;      ///< probe-rs once filled up with zeros.
};

/// Holds the cells of the flash, which outlive the machine as the real ones outlive a power cut.
class FlashChip {
 public:
  static constexpr std::uint32_t kBase = 0x08000000, kBytes = 512 * 1024, kPage = 2048, kUnit = 8;

  FlashChip() : bytes(kBytes, 0xFF), used(kBytes / kUnit, false) {}
  /// Stores the segments of an image, and nothing else. Throws InputError when it is not inside the flash.
  void store(const ElfImage& image);
  /// Stores bytes at an address of the microcontroller. Throws InputError when they are not inside the flash.
  void store(std::uint32_t address, const std::vector<std::uint8_t>& data);
  /// Writes a file as a programmer does, which erases the chip first: `.hex` in Intel's format, whose records contain
  /// their addresses; anything else as bytes from the start of the flash. Throws InputError naming file and line.
  void program_file(const std::filesystem::path& path, const Filling& filling = {});

  /// Makes power fail in the middle of the operation (erase of a page or program of a unit) after the next `more` ones.
  void cut_power_after(std::uint64_t more) { cut_at = operations + more; }

  /// Applies an operation to the cells. With `torn` power fails in its middle: half of the page is erased, or half of
  /// the unit's changing bits are programmed and its ECC is broken.
  void apply(const FlashOperation& operation, bool torn);

 private:
  void write_file(const std::filesystem::path& path);

 public:
  std::vector<std::uint8_t> bytes;
  std::uint32_t options = 0xFFEFF8AA;  ///< The user option bytes begin as they leave the factory (RM0440 §3.4.1).
  /// In this FLASH_WRP1AR the first page lies behind the last one, so nothing is protected.
  std::uint32_t write_protection = 0x7F;
  std::vector<bool> used;        ///< A true flag marks a unit that was programmed since its erase.
  std::set<std::uint32_t> torn;  ///< The ECC of these units (by index) has two wrong bits.
  std::set<std::uint32_t> weak;  ///< One bit of these units (by index) is wrong, which the ECC corrects.
  std::uint64_t operations = 0;
  std::uint64_t cut_at = ~std::uint64_t{0};
  /// Each operation is noted there when it begins; the pointer may be null.
  std::vector<FlashOperation>* log = nullptr;
};

}  // namespace triskin::machine
