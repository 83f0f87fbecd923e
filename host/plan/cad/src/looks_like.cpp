// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>

#include "step_text.hpp"
#include "triskin/base/file_kind.hpp"

namespace triskin::cad {
namespace {

constexpr std::size_t kIgesLine = 80, kIgesSection = 72;

std::string_view without_blanks(std::string_view bytes) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  for (;;) {
    while (!bytes.empty() && std::isspace(static_cast<unsigned char>(bytes.front())) != 0) bytes.remove_prefix(1);
    if (!bytes.starts_with("/*")) return bytes;
    const std::size_t end = bytes.find("*/");
    if (end == std::string_view::npos) return bytes;
    bytes.remove_prefix(end + 2);
  }
}

std::string lower_start(std::string_view bytes) {
  std::string start(bytes.substr(0, 64));
  std::ranges::transform(start, start.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return start;
}

bool is_binary_stl(std::string_view bytes) {
  if (bytes.size() < 84) return false;
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, bytes.data() + 80, sizeof(triangles));
  return bytes.size() == 84 + 50ULL * triangles;
}

}  // namespace

bool is_step(std::string_view bytes) {
  return lower_start(without_blanks(bytes)).starts_with("iso-10303-21");
}

// The first line ends with a section letter and a number in columns 73 to 80; some writers begin with an empty line.
bool is_iges(std::string_view bytes) {
  while (!bytes.empty() && (bytes.front() == '\n' || bytes.front() == '\r')) bytes.remove_prefix(1);
  const std::string_view line = bytes.substr(0, bytes.find('\n'));
  if (line.size() < kIgesLine || (line[kIgesSection] != 'S' && line[kIgesSection] != 'F')) return false;
  return std::ranges::all_of(line.substr(kIgesSection + 1, 7),
                             [](unsigned char c) { return c == ' ' || std::isdigit(c) != 0; });
}

std::string looks_like(std::string_view bytes) {
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff")) return "text in UTF-16; save it as ASCII";
  if (bytes.starts_with("glTF")) return "a GLB mesh; give it its extension .glb";
  if (const std::string kind = not_asked_for(bytes, FileUse::kMesh); !kind.empty()) return kind;
  const std::string start = lower_start(without_blanks(bytes));
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kWords{
      {{"solid", "an STL; give it its extension .stl"},
       {"<?xml", "XML"},
       {"ply", "a PLY mesh; give it its extension .ply"},
       {"off", "an OFF mesh; give it its extension .off"},
       {"v ", "an OBJ mesh; give it its extension .obj"}}};
  for (const auto& [word, name] : kWords) {
    if (start.starts_with(word)) return std::string(name);
  }
  if (is_iges(bytes)) return "an IGES file; give it its extension .igs";
  if (is_binary_stl(bytes)) return "an STL; give it its extension .stl";
  return {};
}

}  // namespace triskin::cad
