// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/machine/flash_chip.hpp"

#include <elf.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <iterator>

#include "triskin/core/bytes.hpp"
#include "triskin/base/error.hpp"

namespace triskin::machine {
namespace {

template <class T>
T at(const std::vector<std::uint8_t>& file, std::size_t offset, const std::string& name) {
  if (offset + sizeof(T) > file.size())
    throw InputError(fmt::format("{}: ELF ends early; build the firmware again", name));
  T value;
  std::memcpy(&value, file.data() + offset, sizeof value);
  return value;
}

void read_symbols(const std::vector<std::uint8_t>& file, const Elf32_Ehdr& head, const std::string& name,
                  ElfImage& image) {
  for (std::size_t s = 0; s < head.e_shnum; ++s) {
    const auto section = at<Elf32_Shdr>(file, head.e_shoff + s * sizeof(Elf32_Shdr), name);
    if (section.sh_type != SHT_SYMTAB) continue;
    const auto strings = at<Elf32_Shdr>(file, head.e_shoff + section.sh_link * sizeof(Elf32_Shdr), name);
    for (std::size_t k = 0; k + sizeof(Elf32_Sym) <= section.sh_size; k += sizeof(Elf32_Sym)) {
      const auto symbol = at<Elf32_Sym>(file, section.sh_offset + k, name);
      std::string text;
      for (std::size_t c = strings.sh_offset + symbol.st_name; c < file.size() && file[c] != 0; ++c)
        text += static_cast<char>(file[c]);
      if (!text.empty()) image.symbols[text] = symbol.st_value;
    }
  }
}

}  // namespace

std::vector<std::uint8_t> ElfImage::flat() const {
  std::vector<std::uint8_t> out;
  for (const auto& [address, data] : segments) {
    out.resize(address - origin(), 0xFF);
    out.insert(out.end(), data.begin(), data.end());
  }
  return out;
}

ElfImage read_elf(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::vector<std::uint8_t> file((std::istreambuf_iterator<char>(in)), {});
  const std::string name = path.string();
  const auto head = at<Elf32_Ehdr>(file, 0, name);
  if (std::memcmp(head.e_ident, ELFMAG, SELFMAG) != 0 || head.e_machine != EM_ARM) {
    throw InputError(fmt::format("{}: not an ARM ELF; give an image of the preset 'firmware'", name));
  }
  ElfImage image;
  for (std::size_t k = 0; k < head.e_phnum; ++k) {
    const auto p = at<Elf32_Phdr>(file, head.e_phoff + k * sizeof(Elf32_Phdr), name);
    if (p.p_type != PT_LOAD || p.p_filesz == 0) continue;
    const auto first = file.begin() + static_cast<std::ptrdiff_t>(p.p_offset);
    image.segments[p.p_paddr].assign(first, first + static_cast<std::ptrdiff_t>(p.p_filesz));
  }
  read_symbols(file, head, name, image);
  return image;
}

void FlashChip::store(std::uint32_t address, const std::vector<std::uint8_t>& data) {
  if (address < kBase || address + data.size() > kBase + kBytes)
    throw InputError(fmt::format("image at {:#x}: outside the flash; check its linker script", address));
  const std::uint32_t offset = address - kBase;
  std::ranges::copy(data, bytes.begin() + offset);
  for (std::size_t k = offset / kUnit; k <= (offset + data.size() - 1) / kUnit; ++k) used[k] = true;
}

void FlashChip::store(const ElfImage& image) {
  for (const auto& [address, data] : image.segments) store(address, data);
}

void FlashChip::apply(const FlashOperation& operation, bool is_torn) {
  if (operation.erase) {
    const std::uint32_t first = operation.index * kPage, size = is_torn ? kPage / 2 : kPage;
    std::fill_n(bytes.begin() + first, size, std::uint8_t{0xFF});
    for (std::uint32_t unit = first / kUnit; unit < (first + size) / kUnit; ++unit) {
      used[unit] = false;
      torn.erase(unit);
    }
    return;
  }
  constexpr std::uint64_t kNotFallen = 0xAAAAAAAAAAAAAAAA;
  const std::uint64_t value = is_torn ? operation.value | kNotFallen : operation.value;
  std::memcpy(&bytes[operation.index * kUnit], &value, sizeof value);
  used[operation.index] = true;
  if (is_torn) torn.insert(operation.index);
}

// The records of docs/firmware_board.md: commit, three starts, confirmation.
void FlashChip::store_application(const ElfImage& image, std::uint32_t slot_bytes, std::uint32_t sequence) {
  store(image);
  const std::vector<std::uint8_t> flat = image.flat();
  std::array<std::uint8_t, 16> commit{};
  ByteWriter w(commit);
  w.le32(0x4D4D4F43);
  w.le32(sequence);
  w.le32(static_cast<std::uint32_t>(flat.size()));
  w.le32(crc32(flat, crc32(w.written())));
  const std::uint32_t records = image.origin() + slot_bytes - kPage;
  store(records, {commit.begin(), commit.end()});
  store(records + 5 * kUnit, std::vector<std::uint8_t>(kUnit, 0));
}

}  // namespace triskin::machine
