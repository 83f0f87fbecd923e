// SPDX-License-Identifier: GPL-3.0-or-later
// What the program asks of the dynamic linker: no library from the current folder, and tables of functions that are
// read-only once the program runs.
#include <elf.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/places.hpp"

namespace triskin {
namespace {

// Reads what the linker does with an ELF file of this computer's own word size.
class ElfFile {
 public:
  explicit ElfFile(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(in), {});
    const auto head = at<Elf64_Ehdr>(0);
    if (std::memcmp(head.e_ident, ELFMAG, SELFMAG) != 0) throw std::runtime_error(file + ": no ELF file");
    for (unsigned k = 0; k < head.e_phnum; ++k)
      segments_.push_back(at<Elf64_Phdr>(head.e_phoff + k * sizeof(Elf64_Phdr)));
    for (const Elf64_Phdr& s : segments_) {
      for (std::size_t k = 0; s.p_type == PT_DYNAMIC && k * sizeof(Elf64_Dyn) < s.p_filesz; ++k)
        entries_.push_back(at<Elf64_Dyn>(s.p_offset + k * sizeof(Elf64_Dyn)));
    }
  }
  [[nodiscard]] bool has_segment(std::uint32_t type) const {
    return std::ranges::any_of(segments_, [=](const Elf64_Phdr& s) { return s.p_type == type; });
  }
  [[nodiscard]] std::optional<std::uint64_t> entry(std::int64_t tag) const {
    for (const Elf64_Dyn& d : entries_) {
      if (d.d_tag == tag) return d.d_un.d_val;
    }
    return std::nullopt;
  }
  // Returns the folders of RPATH and RUNPATH.
  [[nodiscard]] std::vector<std::string> folders() const {
    std::vector<std::string> list;
    for (const std::int64_t tag : {std::int64_t{DT_RPATH}, std::int64_t{DT_RUNPATH}}) {
      const auto text_at = entry(tag);
      if (!text_at) continue;
      std::string text = bytes_.data() + file_offset(*entry(DT_STRTAB)) + *text_at;
      for (std::size_t colon; (colon = text.find(':')) != std::string::npos; text.erase(0, colon + 1))
        list.push_back(text.substr(0, colon));
      list.push_back(text);
    }
    return list;
  }

 private:
  template <class T>
  [[nodiscard]] T at(std::uint64_t offset) const {
    T value;
    if (offset + sizeof value > bytes_.size()) throw std::runtime_error("cut off");
    std::memcpy(&value, bytes_.data() + offset, sizeof value);
    return value;
  }
  [[nodiscard]] std::uint64_t file_offset(std::uint64_t address) const {
    for (const Elf64_Phdr& s : segments_) {
      if (s.p_type == PT_LOAD && address >= s.p_vaddr && address < s.p_vaddr + s.p_filesz)
        return address - s.p_vaddr + s.p_offset;
    }
    throw std::runtime_error("address in no segment");
  }
  std::vector<char> bytes_;
  std::vector<Elf64_Phdr> segments_;
  std::vector<Elf64_Dyn> entries_;
};

TEST(Hardening, the_program_takes_no_library_from_the_current_folder) {
  for (const std::string& folder : ElfFile(test::program_file()).folders())
    EXPECT_TRUE(folder.starts_with('/') || folder.starts_with("$ORIGIN")) << "\"" << folder << "\"";
}

TEST(Hardening, the_program_binds_its_functions_at_the_start_and_makes_them_read_only) {
  const ElfFile program(test::program_file());
  EXPECT_TRUE(program.has_segment(PT_GNU_RELRO));
  EXPECT_NE(program.entry(DT_FLAGS_1).value_or(0) & DF_1_NOW, 0U);
  EXPECT_NE(program.entry(DT_FLAGS_1).value_or(0) & DF_1_PIE, 0U);
}

}  // namespace
}  // namespace triskin
