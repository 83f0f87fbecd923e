// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace triskin::machine {

/// Content of an ELF file: bytes by load address, values of symbols.
struct ElfImage {
  std::map<std::uint32_t, std::vector<std::uint8_t>> segments;  ///< only those with bytes in the file
  std::map<std::string, std::uint32_t> symbols;
  /// One run of bytes from the lowest to the highest load address; gaps are 0xFF.
  [[nodiscard]] std::vector<std::uint8_t> flat() const;
  /// Lowest load address of a segment. The image must have one.
  [[nodiscard]] std::uint32_t origin() const { return segments.begin()->first; }
};
/// Throws InputError naming the file when it is no 32-bit ARM ELF.
[[nodiscard]] ElfImage read_elf(const std::filesystem::path& path);

/// One operation of the silicon on its cells: erases a page, or programs a unit.
struct FlashOperation {
  bool erase = false;
  std::uint32_t index = 0;  ///< index of the page, or of the unit
  std::uint64_t value = 0;  ///< new value of the unit
};

/// The cells of the flash: they outlive the machine, as the real ones outlive a power cut.
class FlashChip {
 public:
  static constexpr std::uint32_t kBase = 0x08000000, kBytes = 512 * 1024, kPage = 2048, kUnit = 8;

  FlashChip() : bytes(kBytes, 0xFF), used(kBytes / kUnit, false) {}
  /// The segments of an image, and nothing else. Throws InputError when it is not inside the flash.
  void store(const ElfImage& image);
  /// Bytes at an address of the microcontroller. Throws InputError when they are not inside the flash.
  void store(std::uint32_t address, const std::vector<std::uint8_t>& data);
  /// Writes a file as a programmer does, which erases the chip first: `.hex` in Intel's format, whose records say where
  /// their bytes go; anything else is bytes from the start of the flash. Throws InputError naming file and line.
  void program_file(const std::filesystem::path& path);

  /// Power fails in the middle of the operation (erase of a page or program of a unit) after the next `more` ones.
  void cut_power_after(std::uint64_t more) { cut_at = operations + more; }

  /// Does an operation to the cells. `torn`: power fails in its middle, half a page erased, or half of a unit's bits
  /// fallen and its ECC broken.
  void apply(const FlashOperation& operation, bool torn);

  std::vector<std::uint8_t> bytes;
  std::uint32_t options = 0xFFEFF8AA;     ///< User option bytes as they leave the factory (RM0440 §3.4.1).
  std::uint32_t write_protection = 0x7F;  ///< FLASH_WRP1AR: its first page lies behind the last one, nothing is
  std::vector<bool> used;                 ///< one flag per unit: programmed since its erase
  std::set<std::uint32_t> torn;           ///< Units (by index) whose ECC has two wrong bits.
  std::uint64_t operations = 0;
  std::uint64_t cut_at = ~std::uint64_t{0};
  std::vector<FlashOperation>* log = nullptr;  ///< each operation that begins is noted there; may be null
};

}  // namespace triskin::machine
