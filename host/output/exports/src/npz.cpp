// SPDX-License-Identifier: GPL-3.0-or-later
#include "npz.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>

#include "triskin/base/terminal_text.hpp"
#include "triskin/core/bytes.hpp"

namespace triskin::exports {
namespace {

std::u32string characters_of(const std::string& text) {
  std::u32string characters;
  for (std::size_t at = 0; at < text.size();) {
    const Utf8Character c = utf8_at(text, at);
    characters += c.bytes == 0 ? U'\uFFFD' : c.code;
    at += std::max<std::size_t>(c.bytes, 1);
  }
  return characters;
}

// Writes little-endian on every computer.
void put(std::string& out, std::uint64_t value, int bytes) {
  for (int k = 0; k < bytes; ++k) out += static_cast<char>(value >> (8 * k) & 0xFF);
}

// Writes the fields that both records of a file in the archive have in common, from the version on.
std::string file_facts(const std::string& name, const std::string& contents) {
  constexpr std::uint64_t kFirstOfJanuary1980 = 0x21;
  std::string facts;
  put(facts, 20, 2);  // The version of the format is 2.0.
  put(facts, 0, 2);
  put(facts, 0, 2);  // The method 0 means "not compressed".
  put(facts, 0, 2);
  put(facts, kFirstOfJanuary1980, 2);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(contents.data());
  put(facts, crc32({bytes, contents.size()}), 4);
  put(facts, contents.size(), 4);
  put(facts, contents.size(), 4);
  put(facts, name.size(), 2);
  put(facts, 0, 2);
  return facts;
}

}  // namespace

void NpzWriter::add_array(const std::string& name, const std::string& type, const std::string& shape,
                          const std::string& data) {
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", type, shape);
  constexpr std::size_t kBeforeHeader = 10, kAlignment = 64;
  header.resize((kBeforeHeader + header.size() + kAlignment) / kAlignment * kAlignment - kBeforeHeader - 1, ' ');
  header += '\n';
  std::string contents("\x93NUMPY\x01\x00", 8);
  put(contents, header.size(), 2);
  contents += header + data;
  const std::string file = name + ".npy", facts = file_facts(file, contents);
  directory_ += std::string("PK\x01\x02", 4);
  put(directory_, 20, 2);
  directory_ += facts;
  put(directory_, 0, 2);  // The fields say: no comment, first disk, no attributes.
  put(directory_, 0, 2);
  put(directory_, 0, 2);
  put(directory_, 0, 4);
  put(directory_, archive_.size(), 4);
  directory_ += file;
  archive_ += std::string("PK\x03\x04", 4) + facts + file + contents;
  ++files_;
}

void NpzWriter::add(const std::string& name, std::span<const double> values, std::size_t columns) {
  std::string data;
  for (const double v : values) put(data, std::bit_cast<std::uint64_t>(v), 8);
  const std::size_t rows = values.size() / columns;
  add_array(name, "<f8", columns == 1 ? fmt::format("({},)", rows) : fmt::format("({}, {})", rows, columns), data);
}

void NpzWriter::add(const std::string& name, std::span<const int> values) {
  std::string data;
  for (const int v : values) put(data, static_cast<std::uint32_t>(v), 4);
  add_array(name, "<i4", fmt::format("({},)", values.size()), data);
}

void NpzWriter::add(const std::string& name, std::span<const std::string> values) {
  std::vector<std::u32string> texts;
  std::size_t length = 1;
  for (const std::string& v : values) {
    texts.push_back(characters_of(v));
    length = std::max(length, texts.back().size());
  }
  std::string data;
  for (const std::u32string& text : texts) {
    for (std::size_t k = 0; k < length; ++k) put(data, k < text.size() ? text[k] : U'\0', 4);
  }
  add_array(name, fmt::format("<U{}", length), fmt::format("({},)", values.size()), data);
}

std::string NpzWriter::finish() {
  const std::size_t begin = archive_.size();
  archive_ += directory_ + std::string("PK\x05\x06", 4);
  put(archive_, 0, 4);
  put(archive_, static_cast<std::uint64_t>(files_), 2);
  put(archive_, static_cast<std::uint64_t>(files_), 2);
  put(archive_, directory_.size(), 4);
  put(archive_, begin, 4);
  put(archive_, 0, 2);
  return std::move(archive_);
}

}  // namespace triskin::exports
