// SPDX-License-Identifier: GPL-3.0-or-later
#include "ply_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "polygon_faces.hpp"
#include "text_numbers.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/index.hpp"

namespace triskin::mesh {
namespace {

enum class Kind : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

// Each type has two names and a size in bytes.
struct TypeRow {
  std::string_view name, other;
  Kind kind;
  std::size_t bytes;
};
constexpr std::array<TypeRow, 8> kTypes{{{"char", "int8", Kind::kInt8, 1},
                                         {"uchar", "uint8", Kind::kUint8, 1},
                                         {"short", "int16", Kind::kInt16, 2},
                                         {"ushort", "uint16", Kind::kUint16, 2},
                                         {"int", "int32", Kind::kInt32, 4},
                                         {"uint", "uint32", Kind::kUint32, 4},
                                         {"float", "float32", Kind::kFloat, 4},
                                         {"double", "float64", Kind::kDouble, 8}}};

struct Property {
  std::string name;
  const TypeRow* type = nullptr;
  const TypeRow* count = nullptr;  // The length of a list has this type.
};
struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

class PlyReader {
 public:
  explicit PlyReader(const MeshSource& source) : bytes_(source.bytes), file_(source.name), notes_(source.notes) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (bytes_.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
  }

  Mesh read() {
    header();
    require_surface();
    for (const Element& e : elements_) {
      if (e.count > bytes_.size()) fail("more elements than bytes");
      for (std::size_t k = 0; k < e.count; ++k) take(e);
    }
    require_end();
    for (auto& polygon : polygons_) {
      for (const VertexIndex v : polygon) {
        if (v < 0 || at(v) >= mesh_.vertices.size()) fail("a face names a vertex that does not exist");
      }
      if (polygon.size() < 3) fail("a face needs three corners");
      add_polygon(mesh_, std::move(polygon));
    }
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}, byte {}: not a mesh that can be read ({}); repair or export the mesh again",
                                 file_, at_, what));
  }

  void header() {
    if (next_line() != "ply") fail("it is not PLY");
    for (std::string line = next_line(); line != "end_header"; line = next_line()) header_line(line);
  }
  // After a CR a binary number may begin with a byte that looks like a LF, so files with CR alone are recognised by
  // their first line.
  std::string next_line() {
    const std::size_t end = bytes_.find_first_of("\r\n", at_);
    if (end == std::string::npos) fail("its header has no end");
    const bool is_pair = bytes_.compare(end, 2, "\r\n") == 0;
    if (!ends_in_cr_) ends_in_cr_ = bytes_[end] == '\r' && !is_pair;
    std::string line = bytes_.substr(at_, end - at_);
    at_ = end + (is_pair && !*ends_in_cr_ ? 2 : 1);
    while (!line.empty() && line.back() == ' ') line.pop_back();
    return line;
  }

  // The vertices must have coordinates for the faces to have a place.
  void require_surface() const {
    if (format_.empty()) fail("its header has no format");
    const auto has = [&](const char* element, auto is_wanted) {
      return std::ranges::any_of(elements_, [&](const Element& e) {
        return e.name == element && std::ranges::any_of(e.properties, is_wanted);
      });
    };
    for (const char* axis : {"x", "y", "z"}) {
      if (!has("vertex", [&](const Property& p) { return p.name == axis; })) fail("its vertices have no x, y and z");
    }
    const auto is_list = [](const Property& p) { return p.count != nullptr && p.name.starts_with("vertex_ind"); };
    if (!has("face", is_list) && !has("tristrips", is_list))
      fail("it has points and no faces: it is a cloud of points, of which another program has to make a mesh");
  }
  void require_end() const {
    const std::size_t rest = text_ ? bytes_.find_first_not_of(" \t\r\n", at_) : at_;
    if (rest < bytes_.size()) fail("more follows than its header says");
    if (text_ && bytes_.back() != '\n' && bytes_.back() != '\r')
      notes_.emplace_back("ends without a line end: if the file was cut, its last number may be another one");
  }
  void header_line(const std::string& line) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "format") {
      words >> format_;
      text_ = format_ == "ascii";
      swapped_ = format_ == "binary_big_endian";
      if (!text_ && !swapped_ && format_ != "binary_little_endian")
        fail(fmt::format("unknown format \"{}\"", format_.substr(0, 20)));
    } else if (word == "element") {
      Element e;
      if (!(words >> e.name >> e.count)) fail("an element without a count");
      elements_.push_back(std::move(e));
    } else if (word == "property") {
      Property p;
      words >> word;
      if (word == "list") {
        words >> word;
        p.count = type_of(word);
        words >> word;
      }
      p.type = type_of(word);
      words >> p.name;
      if (elements_.empty()) fail("a property without an element");
      elements_.back().properties.push_back(std::move(p));
    } else if (word != "comment" && word != "obj_info" && !word.empty()) {
      fail(fmt::format("\"{}\" is no word of its header", word.substr(0, 20)));
    }
  }
  [[nodiscard]] const TypeRow* type_of(const std::string& name) const {
    const auto* row = std::ranges::find_if(kTypes, [&](const TypeRow& r) { return r.name == name || r.other == name; });
    if (row == kTypes.end()) fail(fmt::format("unknown type \"{}\"", name.substr(0, 20)));
    return row;
  }

  void take(const Element& e) {
    Vec3 place = Vec3::Zero();
    for (const Property& p : e.properties) {
      if (p.count != nullptr) {
        list(e, p);
        continue;
      }
      const double value = number(*p.type);
      if (p.name.size() == 1 && p.name[0] >= 'x' && p.name[0] <= 'z') place[p.name[0] - 'x'] = value;
    }
    if (e.name == "vertex") mesh_.vertices.push_back(place);
  }
  void list(const Element& e, const Property& p) {
    const double count = number(*p.count);
    if (!(count >= 0.0 && count <= static_cast<double>(bytes_.size())) || count != std::floor(count))
      fail("a list has no possible length");
    std::vector<VertexIndex> values;
    for (int k = 0; k < static_cast<int>(count); ++k) {
      const double value = number(*p.type);
      if (!(value >= -1.0 && value <= 2e9) || value != std::floor(value))
        fail("a face names a vertex that does not exist");
      values.emplace_back(static_cast<int>(value));
    }
    if (!p.name.starts_with("vertex_ind")) return;
    if (e.name == "tristrips") add_strips(values);
    if (e.name == "face") polygons_.push_back(std::move(values));
  }
  // Three in a row form a triangle, with every second one turned; -1 begins a new strip.
  void add_strips(const std::vector<VertexIndex>& values) {
    std::size_t first = 0;
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (values[k] < 0) first = k + 1;
      if (k < first + 2) continue;
      const bool turned = (k - first) % 2 == 1;
      polygons_.push_back({values[k - 2], values[turned ? k : k - 1], values[turned ? k - 1 : k]});
    }
  }

  double number(const TypeRow& type) { return text_ ? text_number() : binary_number(type); }
  double text_number() {
    constexpr std::string_view kSpace = " \t\r\n";
    at_ = std::min(bytes_.find_first_not_of(kSpace, at_), bytes_.size());
    const std::size_t end = std::min(bytes_.find_first_of(kSpace, at_), bytes_.size());
    const std::string_view word = std::string_view(bytes_).substr(at_, end - at_);
    if (word.empty()) fail("the file ends early: it was cut");
    const auto value = decimal_number(word);
    if (!value) {
      fail(has_decimal_comma(word)
               ? "its numbers have decimal commas; export it with points, as under the language English"
               : "no number");
    }
    at_ = end;
    return *value;
  }
  double binary_number(const TypeRow& type) {
    if (bytes_.size() - at_ < type.bytes) fail("the file ends early: it was cut");
    std::array<char, 8> raw{};
    std::memcpy(raw.data(), bytes_.data() + at_, type.bytes);
    at_ += type.bytes;
    if (swapped_) std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(type.bytes));
    const auto as = [&]<class T>(T value) {
      std::memcpy(&value, raw.data(), sizeof(value));
      return static_cast<double>(value);
    };
    switch (type.kind) {
      case Kind::kInt8:
        return as(std::int8_t{});
      case Kind::kUint8:
        return as(std::uint8_t{});
      case Kind::kInt16:
        return as(std::int16_t{});
      case Kind::kUint16:
        return as(std::uint16_t{});
      case Kind::kInt32:
        return as(std::int32_t{});
      case Kind::kUint32:
        return as(std::uint32_t{});
      case Kind::kFloat:
        return as(float{});
      case Kind::kDouble:
        return as(double{});
    }
    return 0.0;
  }

  static_assert(std::endian::native == std::endian::little);
  const std::string& bytes_;
  const std::string& file_;
  std::vector<std::string>& notes_;
  std::string format_;
  std::optional<bool> ends_in_cr_;  // True if the first line ends in CR.
  std::size_t at_ = 0;
  bool text_ = false, swapped_ = false;
  std::vector<Element> elements_;
  std::vector<std::vector<VertexIndex>> polygons_;
  Mesh mesh_;
};

}  // namespace

Mesh read_ply(const MeshSource& source) {
  return PlyReader(source).read();
}

}  // namespace triskin::mesh
