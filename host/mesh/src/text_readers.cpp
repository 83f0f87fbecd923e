// SPDX-License-Identifier: GPL-3.0-or-later
// Our own readers of the formats in which most meshes come: the library that reads the others keeps single precision.
#include "text_readers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "lower_case.hpp"
#include "polygon_faces.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/index.hpp"

namespace triskin::geometry {
namespace {

constexpr std::size_t kStlHeader = 84, kStlFacet = 50;  // bytes
constexpr std::string_view kSpace = " \t\r\f\v";

// Next word of the line, which loses it; empty at the end.
std::string_view word_of(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kSpace), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kSpace));
  line.remove_prefix(word.size());
  return word;
}

// What is left of the line, without spaces at its ends; the line is empty then.
std::string rest_of(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kSpace), line.size()));
  const std::string rest(line.substr(0, line.find_last_not_of(kSpace) + 1));
  line = {};
  return rest;
}

template <class Number>
std::optional<Number> number_of(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  Number value{};
  const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || rest != word.data() + word.size()) return std::nullopt;
  return value;
}

std::optional<Vec3> point_of(std::string_view& line) {
  Vec3 p;
  for (double& c : p) {
    const auto value = number_of<double>(word_of(line));
    if (!value) return std::nullopt;
    c = *value;
  }
  return p;
}

// Calls `take` with each line and its number; a backslash at the end joins the next line.
template <class Take>
void each_line(std::string_view text, Take take) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  int number = 0;
  std::string joined;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    while (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (line.ends_with('\\')) {
      joined.append(line.substr(0, line.size() - 1)).append(" ");
      continue;
    }
    if (joined.empty()) {
      take(line, number);
      continue;
    }
    joined.append(line);
    take(std::string_view(joined), number);
    joined.clear();
  }
}

[[noreturn]] void fail(const std::string& file, int line, const char* what) {
  throw InputError(
      fmt::format("{}, line {}: not a mesh that can be read ({}); repair or export the mesh again", file, line, what));
}

}  // namespace

Mesh read_obj(const std::string& text, const std::string& file, ObjectFilter& objects) {
  Mesh mesh;
  std::array<bool, 2> is_in{};  // the object, one of the groups
  std::vector<int> corners;
  each_line(text, [&](std::string_view line, int number) {
    const std::string_view kind = word_of(line);
    if (kind == "v") {
      const auto p = point_of(line);
      if (!p) fail(file, number, "a vertex must be three numbers");
      mesh.vertices.push_back(*p);
    }
    if (kind == "o" || kind == "g") {
      bool& is_named = is_in[kind == "o" ? 0 : 1] = false;
      if (kind == "o") is_named = objects.meets(rest_of(line));
      for (std::string_view word = word_of(line); !word.empty(); word = word_of(line))
        is_named = objects.meets(std::string(word)) || is_named;
    }
    if (kind != "f" || (!objects.wanted.empty() && !is_in[0] && !is_in[1])) return;
    corners.clear();
    for (std::string_view word = word_of(line); !word.empty() && word.front() != '#'; word = word_of(line)) {
      const auto index = number_of<long>(word.substr(0, word.find('/')));
      const long count = static_cast<long>(mesh.vertices.size());
      const long v = !index ? -1 : *index > 0 ? *index - 1 : count + *index;
      if (!index || *index == 0 || v < 0 || v >= count) fail(file, number, "a face names a vertex that does not exist");
      corners.push_back(static_cast<int>(v));
    }
    if (corners.size() == 3)
      mesh.faces.push_back({corners[0], corners[1], corners[2]});
    else
      add_polygon(mesh, corners);
  });
  return mesh;
}

bool is_binary_stl(const std::string& bytes) {
  if (bytes.size() < kStlHeader) return false;
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof(count));
  if (bytes.size() == kStlHeader + kStlFacet * std::size_t{count}) return true;
  const std::string_view head = std::string_view(bytes).substr(0, 1000);
  const bool text = head.find("facet") != std::string_view::npos || head.find("endsolid") != std::string_view::npos;
  return !text && bytes.find('\0') != std::string::npos;
}

Mesh read_binary_stl(const std::string& bytes) {
  Mesh mesh;
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof(count));
  const std::size_t held = (bytes.size() - kStlHeader) / kStlFacet;
  const std::size_t facets = count == 0 ? held : std::min<std::size_t>(count, held);
  mesh.vertices.reserve(3 * facets);
  mesh.faces.reserve(facets);
  for (std::size_t f = 0; f < facets; ++f) {
    std::array<float, 9> c{};
    std::memcpy(c.data(), bytes.data() + kStlHeader + f * kStlFacet + 12, sizeof(c));
    const int first = static_cast<int>(mesh.vertices.size());
    for (std::size_t k = 0; k < 9; k += 3)
      mesh.vertices.emplace_back(static_cast<double>(c[k]), static_cast<double>(c[k + 1]),
                                 static_cast<double>(c[k + 2]));
    mesh.faces.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

Mesh read_text_stl(const std::string& text, const std::string& file, ObjectFilter& objects) {
  Mesh mesh;
  std::vector<int> corners;
  bool known = false, is_in = objects.wanted.empty();
  each_line(text, [&](std::string_view line, int number) {
    const std::string kind = lower_case(word_of(line));
    known = known || kind == "solid" || kind == "facet";
    if (kind == "solid") is_in = objects.meets(rest_of(line)) || objects.wanted.empty();
    if (kind == "outer" || kind == "facet") corners.clear();
    if (kind == "endloop" && is_in) add_polygon(mesh, std::exchange(corners, {}));
    if (kind != "vertex") return;
    const auto p = point_of(line);
    if (!p) fail(file, number, "a vertex must be three numbers");
    corners.push_back(static_cast<int>(mesh.vertices.size()));
    mesh.vertices.push_back(*p);
  });
  if (!known) fail(file, 1, "it is not STL");
  return mesh;
}

}  // namespace triskin::geometry
