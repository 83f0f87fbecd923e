// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/machine/flash_chip.hpp"

#include <elf.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <fstream>
#include <iterator>

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

namespace {

std::vector<std::uint8_t> record_bytes(const std::string& line, const std::string& where) {
  const auto bad = [&where](const char* what) {
    return InputError(fmt::format("{}: {}; build the factory file again", where, what));
  };
  if (line.size() < 11 || line.size() % 2 == 0 || line[0] != ':') throw bad("no record of an Intel hex file");
  std::vector<std::uint8_t> bytes;
  unsigned sum = 0;
  for (std::size_t k = 1; k < line.size(); k += 2) {
    unsigned value = 0;
    const auto [end, error] = std::from_chars(line.data() + k, line.data() + k + 2, value, 16);
    if (error != std::errc{} || end != line.data() + k + 2) throw bad("not hexadecimal");
    bytes.push_back(static_cast<std::uint8_t>(value));
    sum += value;
  }
  if ((sum & 0xFF) != 0 || bytes[0] + 5U != bytes.size()) throw bad("length or check sum is wrong");
  return bytes;
}

}  // namespace

// A unit of the filling counts as programmed, also where it reads as erased: the worse case for what comes later.
void FlashChip::program_file(const std::filesystem::path& path, const Filling& filling) {
  write_file(path);
  if (filling.block_bytes == 0) return;
  const std::size_t units = filling.block_bytes / kUnit;
  for (std::size_t first = 0; first < used.size(); first += units) {
    const auto block = std::ranges::subrange(used.begin() + static_cast<std::ptrdiff_t>(first),
                                             used.begin() + static_cast<std::ptrdiff_t>(first + units));
    if (std::ranges::none_of(block, [](bool u) { return u; })) continue;
    for (std::size_t k = first; k < first + units; ++k) {
      if (!used[k]) std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(k * kUnit), kUnit, filling.value);
      used[k] = true;
    }
  }
}

void FlashChip::write_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(fmt::format("{}: cannot be read; build the preset 'firmware'", path.string()));
  std::ranges::fill(bytes, std::uint8_t{0xFF});
  used.assign(used.size(), false);
  torn.clear();
  if (path.extension() != ".hex") return store(kBase, {std::istreambuf_iterator<char>(in), {}});
  constexpr std::uint8_t kData = 0, kEnd = 1, kUpperAddress = 4, kEntry = 5;
  std::uint32_t upper = 0;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    const std::string where = fmt::format("{}:{}", path.string(), ++number);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const std::vector<std::uint8_t> record = record_bytes(line, where);
    const std::uint8_t kind = record[3];
    if (kind == kEnd) return;
    if (kind == kUpperAddress) upper = static_cast<std::uint32_t>(record[4] << 8 | record[5]) << 16;
    if (kind == kData)
      store(upper | static_cast<std::uint32_t>(record[1] << 8 | record[2]), {record.begin() + 4, record.end() - 1});
    else if (kind != kUpperAddress && kind != kEntry)
      throw InputError(fmt::format("{}: record type {} is not written by the build", where, kind));
  }
  throw InputError(fmt::format("{}: ends without its last record; build the factory file again", path.string()));
}

}  // namespace triskin::machine
