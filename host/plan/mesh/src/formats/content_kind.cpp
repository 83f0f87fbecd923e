// SPDX-License-Identifier: GPL-3.0-or-later
#include "content_kind.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "off_reader.hpp"
#include "stl_reader.hpp"
#include "text_numbers.hpp"
#include "triskin/base/file_kind.hpp"
#include "triskin/base/lower_case.hpp"

namespace triskin::mesh {
namespace {

constexpr std::size_t kLooked = 4096;  // The kind is recognised from this many bytes at the beginning.

std::string_view head_of(std::string_view bytes) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  return bytes.substr(0, kLooked);
}

std::string_view without_space(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \t\r\n");
  return from == std::string_view::npos ? std::string_view() : text.substr(from);
}

// Recognises a word that begins a line of an OBJ, with a number or name after it.
bool begins_as_obj(std::string_view text) {
  LineReader lines(text);
  for (std::string_view line; lines.next(line);) {
    const std::string_view word = next_word(line);
    if (word.empty() || word.front() == '#') continue;
    constexpr std::array<std::string_view, 9> kWords{"v", "vt", "vn", "f", "o", "g", "s", "mtllib", "usemtl"};
    return std::ranges::find(kWords, word) != kWords.end() && !next_word(line).empty();
  }
  return false;
}

bool is_text_stl(std::string_view text) {
  const std::string lower = lower_case(without_space(text));
  return (lower.starts_with("solid") && lower.find("facet") != std::string::npos) || lower.starts_with("facet");
}

}  // namespace

std::string_view name_of(MeshFormat format) {
  constexpr std::array<std::string_view, 9> kNames{
      "OBJ", "STL", "STL", "PLY", "OFF", "3MF", "glTF", "DAE", "an unknown format"};
  return kNames[static_cast<std::size_t>(format)];
}

MeshFormat format_by_content(const std::string& bytes) {
  const std::string_view head = head_of(bytes), text = without_space(head);
  if (head.starts_with("ply\n") || head.starts_with("ply\r")) return MeshFormat::kPly;
  if (head.starts_with("PK\x03\x04")) return MeshFormat::kThreeMf;
  if (head.starts_with("glTF")) return MeshFormat::kGltf;
  if (is_binary_stl(bytes) && bytes.size() >= 84) {
    // Only the length that the count demands is proof, because any bytes may hold a zero.
    std::size_t count = 0;
    for (int k = 3; k >= 0; --k)
      count = count << 8 | static_cast<unsigned char>(bytes[80 + static_cast<std::size_t>(k)]);
    if (bytes.size() == 84 + 50 * count) return MeshFormat::kBinaryStl;
  }
  if (is_text_stl(head)) return MeshFormat::kTextStl;
  if (text.starts_with('{') && !file_kind(bytes)) return MeshFormat::kGltf;
  if (const std::string root = root_element(head); !root.empty())
    return root == "collada" ? MeshFormat::kDae : MeshFormat::kUnknown;
  if (is_off(head)) return MeshFormat::kOff;
  return begins_as_obj(head) ? MeshFormat::kObj : MeshFormat::kUnknown;
}

MeshFormat format_by_extension(std::string_view extension) {
  constexpr auto kRows = std::to_array<std::pair<std::string_view, MeshFormat>>({
      {".obj", MeshFormat::kObj},
      {".stl", MeshFormat::kTextStl},
      {".ply", MeshFormat::kPly},
      {".off", MeshFormat::kOff},
      {".3mf", MeshFormat::kThreeMf},
      {".gltf", MeshFormat::kGltf},
      {".glb", MeshFormat::kGltf},
      {".dae", MeshFormat::kDae},
  });
  const auto* row = std::ranges::find(kRows, extension, &std::pair<std::string_view, MeshFormat>::first);
  return row == kRows.end() ? MeshFormat::kUnknown : row->second;
}

}  // namespace triskin::mesh
