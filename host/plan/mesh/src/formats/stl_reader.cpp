// SPDX-License-Identifier: GPL-3.0-or-later
#include "stl_reader.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "polygon_faces.hpp"
#include "text_numbers.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/lower_case.hpp"

namespace triskin::mesh {
namespace {

constexpr std::size_t kHeaderBytes = 84, kFacetBytes = 50;

std::uint32_t stated_count(const std::string& bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kHeaderBytes - sizeof(count), sizeof(count));
  return count;
}

// Returns the number of whole facets in the file; throws if the count promises more.
std::size_t facets_of(const MeshSource& source) {
  const std::uint32_t count = stated_count(source.bytes);
  const std::size_t held = (source.bytes.size() - kHeaderBytes) / kFacetBytes;
  const std::size_t rest = (source.bytes.size() - kHeaderBytes) % kFacetBytes;
  if (count == 0 || count == std::numeric_limits<std::uint32_t>::max()) {
    source.notes.push_back(fmt::format("its count of triangles is {}, which stands for unknown: {} are in it{}", count,
                                       held, rest == 0 ? "" : " and a part of one more, so that it was cut"));
    return held;
  }
  if (held < count) {
    throw InputError(
        fmt::format("{}: it was cut: it holds {} of {} triangles; copy or export it again", source.name, held, count));
  }
  const std::size_t behind = source.bytes.size() - kHeaderBytes - kFacetBytes * std::size_t{count};
  if (behind > 0) {
    source.notes.push_back(fmt::format("{} bytes behind the last of its {} triangles were left out", behind, count));
  }
  return count;
}

class TextStl {
 public:
  explicit TextStl(const MeshSource& source) : source_(source), lines_(source.bytes) {}

  Mesh read() {
    is_in_ = source_.objects.wanted.empty();
    while (next()) take();
    if (in_facet_) fail("the file ends in a facet: it was cut; copy or export it again");
    if (in_solid_) fail("\"endsolid\" is missing: the file was cut; copy or export it again");
    if (!has_solid_) source_.notes.emplace_back("has no \"solid\" and no \"endsolid\": if it was cut, nobody can say");
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}, line {}: not a mesh that can be read ({}); repair or export the mesh again",
                                 source_.name, lines_.number(), what));
  }

  // Takes the next word of the file into word_, in lower case.
  bool next() {
    word_ = lower_case(next_word(line_));
    while (word_.empty()) {
      if (!lines_.next(line_)) return false;
      word_ = lower_case(next_word(line_));
    }
    return true;
  }

  void take() {
    if (word_ == "solid") return solid();
    if (word_ == "endsolid") return end_solid();
    if (word_ == "facet") return facet();
    if (word_ == "vertex") return vertex();
    if (word_ == "endloop") return end_loop();
    if (word_ == "outer") {
      if (!next() || word_ != "loop") fail("\"outer\" without \"loop\"");
      corners_.clear();
    } else if (word_ == "endfacet") {
      if (!in_facet_ || !corners_.empty()) fail("\"endfacet\" where no facet ends");
      in_facet_ = false;
    } else {
      fail(fmt::format("\"{}\" is no word of STL", word_.substr(0, 20)));
    }
  }

  void solid() {
    if (in_solid_) fail("\"endsolid\" is missing before a new \"solid\"");
    in_solid_ = has_solid_ = true;
    is_in_ = source_.objects.meets(name()) || source_.objects.wanted.empty();
  }
  void end_solid() {
    if (in_facet_ || !in_solid_) fail("\"endsolid\" where no solid ends");
    in_solid_ = false;
    (void)name();
  }
  // Returns the rest of the line; in a file without line breaks, only the text before the first facet or solid.
  std::string name() {
    const std::string lower = lower_case(line_);
    const std::size_t end = std::min({lower.find("facet normal"), lower.find(" solid "), line_.size()});
    std::string_view text = line_.substr(0, end);
    line_.remove_prefix(end);
    text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
    return std::string(text.substr(0, text.find_last_not_of(kBlanks) + 1));
  }

  // The normal is computed from the corners, so a missing or malformed one does no harm.
  void facet() {
    if (in_facet_) fail("\"endfacet\" is missing before a new \"facet\"");
    in_facet_ = true;
    constexpr int kMaxWords = 6;
    for (int k = 0; k < kMaxWords && next(); ++k) {
      if (word_ == "outer") return take();
    }
    fail("a facet without \"outer loop\"");
  }

  void vertex() {
    if (!in_facet_) fail("a vertex outside a facet");
    Vec3 p;
    for (double& c : p) {
      if (!next()) fail("the file ends in a vertex: it was cut");
      const auto value = decimal_number(word_);
      if (!value) {
        fail(has_decimal_comma(word_)
                 ? "its numbers have decimal commas; export it with points, as under the language English"
                 : "a vertex must be three numbers");
      }
      c = *value;
    }
    corners_.emplace_back(mesh_.vertices.size());
    mesh_.vertices.push_back(p);
  }

  void end_loop() {
    if (!in_facet_ || corners_.size() < 3) fail("a loop needs three corners");
    if (is_in_) add_polygon(mesh_, std::exchange(corners_, {}));
    corners_.clear();
  }

  const MeshSource& source_;
  LineReader lines_;
  std::string_view line_;
  std::string word_;
  Mesh mesh_;
  std::vector<VertexIndex> corners_;
  bool is_in_ = false, in_solid_ = false, in_facet_ = false, has_solid_ = false;
};

}  // namespace

bool is_binary_stl(const std::string& bytes) {
  if (bytes.size() < kHeaderBytes) return false;
  if (bytes.size() == kHeaderBytes + kFacetBytes * std::size_t{stated_count(bytes)}) return true;
  const std::string_view head = std::string_view(bytes).substr(0, 1000);
  const bool is_text = head.find("facet") != std::string_view::npos || head.find("endsolid") != std::string_view::npos;
  return !is_text && bytes.find('\0') != std::string::npos;
}

Mesh read_binary_stl(const MeshSource& source) {
  Mesh mesh;
  const std::size_t facets = facets_of(source);
  mesh.vertices.reserve(3 * facets);
  mesh.faces.reserve(facets);
  for (std::size_t f = 0; f < facets; ++f) {
    std::array<float, 9> c{};
    std::memcpy(c.data(), source.bytes.data() + kHeaderBytes + f * kFacetBytes + 12, sizeof(c));
    const int first = static_cast<int>(mesh.vertices.size());
    for (std::size_t k = 0; k < 9; k += 3) {
      mesh.vertices.emplace_back(static_cast<double>(c[k]), static_cast<double>(c[k + 1]),
                                 static_cast<double>(c[k + 2]));
    }
    mesh.faces.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

Mesh read_text_stl(const MeshSource& source) {
  return TextStl(source).read();
}

}  // namespace triskin::mesh
