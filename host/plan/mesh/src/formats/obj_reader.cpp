// SPDX-License-Identifier: GPL-3.0-or-later
// We read OBJ ourselves, because the library that reads the rarer formats keeps single precision.
#include "obj_reader.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>
#include <vector>

#include "polygon_faces.hpp"
#include "text_numbers.hpp"
#include "triskin/base/error.hpp"

namespace triskin::mesh {
namespace {

// The specification and common extensions define these words, which carry no polygon.
constexpr std::array<std::string_view, 32> kOtherWords{
    "vt",  "vn",    "vp",    "l",    "p",     "s",        "mg",       "mtllib", "usemtl",     "maplib",    "usemap",
    "deg", "bmat",  "step",  "con",  "bevel", "c_interp", "d_interp", "lod",    "shadow_obj", "trace_obj", "call",
    "csh", "ctech", "stech", "parm", "trim",  "hole",     "scrv",     "sp",     "end",        "cstype"};

class ObjReader {
 public:
  explicit ObjReader(const MeshSource& source) : source_(source), lines_(source.bytes) {}

  Mesh read() {
    std::string_view line;
    std::string joined;
    while (lines_.next(line)) {
      last_ = line;
      if (line.ends_with('\\')) {
        joined.append(line.substr(0, line.size() - 1)).append(" ");
        continue;
      }
      if (joined.empty()) {
        take(line);
        continue;
      }
      joined.append(line);
      take(joined);
      joined.clear();
    }
    if (!joined.empty()) fail("the file ends in a line that goes on");
    add_notes();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}, line {}: not a mesh that can be read ({}); repair or export the mesh again",
                                 source_.name, lines_.number(), what));
  }

  void take(std::string_view line) {
    const std::string_view word = next_word(line);
    if (word.empty() || word.front() == '#') return;
    if (word == "v") return vertex(line);
    if (word == "f" || word == "fo") return face(line);
    if (word == "o" || word == "g") return name(word, line);
    if (word == "curv" || word == "curv2" || word == "surf") {
      ++free_forms_;
      return;
    }
    if (std::ranges::find(kOtherWords, word) != kOtherWords.end()) return;
    if (unknown_++ == 0) first_unknown_ = fmt::format("\"{}\" in line {}", word.substr(0, 20), lines_.number());
  }

  void vertex(std::string_view line) {
    Vec3 p;
    for (double& c : p) {
      const std::string_view word = next_word(line);
      const auto value = decimal_number(word);
      if (!value) fail(has_decimal_comma(word) ? kCommas : "a vertex must be three numbers");
      c = *value;
    }
    // Exporters write a fourth number 1, or three for a colour.
    const auto weight = decimal_number(next_word(line));
    if (weight && *weight != 1.0 && next_word(line).empty()) ++weighted_;
    mesh_.vertices.push_back(p);
    is_used_.push_back(false);
  }

  void name(std::string_view word, std::string_view line) {
    bool& is_named = is_in_[word == "o" ? 0 : 1] = false;
    if (word == "o") {
      line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
      is_named = source_.objects.meets(std::string(line.substr(0, line.find_last_not_of(kBlanks) + 1)));
      return;
    }
    for (std::string_view group = next_word(line); !group.empty(); group = next_word(line))
      is_named = source_.objects.meets(std::string(group)) || is_named;
  }

  void face(std::string_view line) {
    std::vector<VertexIndex> corners;
    for (std::string_view word = next_word(line); !word.empty() && word.front() != '#'; word = next_word(line))
      corners.push_back(corner(word));
    if (corners.size() < 3) fail("a face needs three corners");
    for (const VertexIndex v : corners) is_used_[static_cast<std::size_t>(v)] = true;
    if (!source_.objects.wanted.empty() && !is_in_[0] && !is_in_[1]) return;
    if (corners.size() == 3)
      mesh_.faces.push_back({corners[0], corners[1], corners[2]});
    else
      add_polygon(mesh_, std::move(corners));
  }
  [[nodiscard]] VertexIndex corner(std::string_view word) const {
    const auto index = whole_number(word.substr(0, word.find('/')));
    if (!index) fail("a corner of a face is no number");
    const long count = static_cast<long>(mesh_.vertices.size());
    const long v = *index > 0 ? *index - 1 : count + *index;
    if (*index == 0 || v < 0 || v >= count) fail("a face names a vertex that does not exist");
    return VertexIndex(v);
  }

  void add_notes() {
    std::string_view line = last_;
    const std::string_view word = next_word(line);
    if (!lines_.has_end() && (word == "f" || word == "v")) {
      source_.notes.push_back(
          fmt::format("ends without a line end: if the file was cut, its last line \"{}\" may be "
                      "another one and more may be missing",
                      last_.substr(0, 60)));
    }
    const auto unused = std::ranges::count(is_used_, false);
    if (unused > 0 && !mesh_.faces.empty()) {
      source_.notes.push_back(fmt::format("{} of {} vertices belong to no face; if the file was cut, faces are missing",
                                          unused, mesh_.vertices.size()));
    }
    if (weighted_ > 0) {
      source_.notes.push_back(fmt::format(
          "{} vertices have a weight other than 1, which counts for curves only and was not applied", weighted_));
    }
    if (free_forms_ > 0)
      source_.notes.push_back(fmt::format("{} free-form curves and surfaces were left out", free_forms_));
    if (unknown_ > 0) {
      source_.notes.push_back(
          fmt::format("{} lines that are not OBJ were left out, the first is {}", unknown_, first_unknown_));
    }
  }

  static constexpr const char* kCommas =
      "its numbers have decimal commas; export it with points, as under the language English";
  const MeshSource& source_;
  LineReader lines_;
  Mesh mesh_;
  std::vector<bool> is_used_;
  // The first flag tells whether we are in the wanted object, the second whether in a wanted group.
  std::array<bool, 2> is_in_{};
  std::string_view last_;
  int free_forms_ = 0, unknown_ = 0, weighted_ = 0;
  std::string first_unknown_;
};

}  // namespace

Mesh read_obj(const MeshSource& source) {
  return ObjReader(source).read();
}

}  // namespace triskin::mesh
