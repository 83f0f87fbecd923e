// SPDX-License-Identifier: GPL-3.0-or-later
#include "collada_counts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "text_numbers.hpp"
#include "triskin/base/error.hpp"
#include "xml_reader.hpp"

namespace triskin::mesh {
namespace {

class ColladaCounts {
 public:
  explicit ColladaCounts(const MeshSource& source) : source_(source) {}

  double run() {
    XmlHandler handler;
    handler.start = [&](const XmlTag& tag) { start(tag); };
    handler.end = [&](std::string_view, std::string_view name) { end(name); };
    handler.text = [&](std::string_view piece) {
      if (!is_list_) return;
      for (const char c : piece) text_ += c == '\n' ? ' ' : c;
    };
    parse_xml(source_.bytes, source_.name, handler);
    return unit_mm_;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(
        fmt::format("{}, line {}: {}: the file was cut or changed; export it again", source_.name, line_, what));
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(fmt::format("{}, line {}: {}", source_.name, line_, what));
  }

  void start(const XmlTag& tag) {
    line_ = tag.line;
    if (tag.name == "unit" && unit_mm_ == 0.0) take_unit(tag);
    if (tag.name == "node") nodes_.emplace_back(tag.attribute("id"));
    if (tag.name == "instance_node") take_instance(tag);
    if (tag.name == "skew") refuse("a node has a skew, which is not read; apply the transforms when you export it");
    is_list_ = tag.name == "float_array" || tag.name == "p" || tag.name == "vcount";
    if (tag.name == "triangles" || tag.name == "polylist") {
      polygons_ = whole_number(tag.attribute("count"));
      stride_ = 1;
      corners_.reset();
      is_triangles_ = tag.name == "triangles";
      is_polylist_ = !is_triangles_;
    }
    if (tag.name == "input") stride_ = std::max(stride_, 1 + whole_number(tag.attribute("offset")).value_or(0));
    if (!is_list_) return;
    text_.clear();
    stated_ = whole_number(tag.attribute("count"));
  }

  void end(std::string_view name) {
    if (name == "node" && !nodes_.empty()) nodes_.pop_back();
    if (name == "float_array") end_of_array();
    if (name == "vcount") end_of_corner_counts();
    if (name == "p" && is_triangles_) end_of_triangles();
    if (name == "p" && is_polylist_) end_of_polygons();
    if (name == "triangles" || name == "polylist") is_triangles_ = is_polylist_ = false;
    is_list_ = false;
  }

  void take_unit(const XmlTag& tag) {
    const std::string_view text = tag.attribute("meter");
    if (text.data() == nullptr) return;
    const auto metres = decimal_number(text);
    if (!metres || !std::isfinite(*metres) || !(*metres > 0.0))
      refuse(fmt::format("its unit is \"{}\" metres; state a length above 0", text.substr(0, 20)));
    unit_mm_ = 1000.0 * *metres;
  }

  // The library follows such instances until its stack ends.
  void take_instance(const XmlTag& tag) {
    std::string_view url = tag.attribute("url");
    if (!url.starts_with('#')) return;
    url.remove_prefix(1);
    for (const std::string& node : nodes_) instances_[node].emplace(url);
    std::set<std::string> seen;
    if (std::ranges::any_of(nodes_, [&](const std::string& node) { return reaches(std::string(url), node, seen); }))
      refuse(fmt::format("the node \"{}\" is an instance of itself", url.substr(0, 40)));
  }

  bool reaches(const std::string& from, const std::string& wanted, std::set<std::string>& seen) const {
    if (from == wanted) return true;
    const auto found = instances_.find(from);
    if (found == instances_.end() || !seen.insert(from).second) return false;
    return std::ranges::any_of(found->second, [&](const std::string& next) { return reaches(next, wanted, seen); });
  }

  void end_of_array() {
    long held = 0;
    std::string_view rest = text_;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest), ++held) {
      if (decimal_number(word)) continue;
      fail(has_decimal_comma(word)
               ? "its numbers have decimal commas; export it with points, as under the language English"
               : fmt::format("\"{}\" is no number", word.substr(0, 20)));
    }
    if (stated_ && *stated_ != held) fail(fmt::format("an array of {} numbers holds {}", *stated_, held));
  }

  // Returns the sum of the list and writes its length into `count`.
  [[nodiscard]] long whole_numbers(long& count) const {
    long sum = 0;
    count = 0;
    std::string_view rest = text_;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest), ++count) {
      const auto value = whole_number(word);
      constexpr long kMaxIndex = 1L << 31;
      if (!value || *value < 0 || *value >= kMaxIndex)
        fail(fmt::format("\"{}\" in a list of corners is no index", word.substr(0, 20)));
      sum += *value;
    }
    return sum;
  }

  void end_of_corner_counts() {
    long polygons = 0;
    corners_ = whole_numbers(polygons);
    if (polygons_ && *polygons_ != polygons)
      fail(fmt::format("a list of {} polygons has the corners of {}", *polygons_, polygons));
  }

  void end_of_polygons() {
    long held = 0;
    (void)whole_numbers(held);
    if (corners_ && held != *corners_ * stride_)
      fail(fmt::format("polygons with {} corners have {} indices, not {}", *corners_, held, *corners_ * stride_));
  }

  void end_of_triangles() {
    long held = 0;
    (void)whole_numbers(held);
    if (held % (3 * stride_) != 0) fail(fmt::format("{} indices are no whole number of triangles", held));
    const long triangles = held / (3 * stride_);
    if (polygons_ && *polygons_ != triangles)
      fail(fmt::format("a list of {} triangles holds {}", *polygons_, triangles));
  }

  const MeshSource& source_;
  double unit_mm_ = 0.0;
  long line_ = 0, stride_ = 1;
  std::optional<long> polygons_, stated_, corners_;
  bool is_list_ = false, is_triangles_ = false, is_polylist_ = false;
  std::string text_;
  std::vector<std::string> nodes_;  // These are the identifiers of the open nodes, outermost first.
  std::map<std::string, std::set<std::string>> instances_;
};

}  // namespace

double checked_collada_unit_mm(const MeshSource& source) {
  return ColladaCounts(source).run();
}

}  // namespace triskin::mesh
