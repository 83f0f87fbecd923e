// SPDX-License-Identifier: GPL-3.0-or-later
#include "svg_style.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>
#include <utility>
#include <vector>

#include "triskin/base/error.hpp"

namespace triskin::placement {
namespace {

std::string_view trimmed(std::string_view s) {
  const std::size_t from = s.find_first_not_of(" \t\r\n");
  return from == std::string_view::npos ? std::string_view() : s.substr(from, s.find_last_not_of(" \t\r\n") + 1 - from);
}
// "display: none !important" in two.
std::pair<std::string_view, std::string_view> declaration(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return {};
  const std::string_view value = text.substr(colon + 1);
  return {trimmed(text.substr(0, colon)), trimmed(value.substr(0, value.find('!')))};
}
// What decides whether a shape belongs to the outline.
bool is_paint(std::string_view key) {
  constexpr std::array<std::string_view, 7> kPaint{"fill",    "stroke",  "fill-opacity", "stroke-opacity",
                                                   "opacity", "display", "visibility"};
  return std::ranges::find(kPaint, key) != kPaint.end();
}
// What moves, cuts or shapes it other than by a length.
bool is_shape(std::string_view key) {
  constexpr std::array<std::string_view, 7> kShape{"transform", "translate", "rotate", "scale",
                                                   "clip-path", "mask",      "d"};
  return std::ranges::find(kShape, key) != kShape.end();
}

bool is_zero(std::string_view text) {
  double value = 1.0;
  (void)std::from_chars(text.data(), text.data() + text.size(), value);
  return value == 0.0;
}

// transparent, #rgb0, #rrggbb00, rgba(…, 0) and hsla(…, 0), rgb(… / 0%) (CSS Color 4).
bool has_no_alpha(const std::string& color) {
  if (color == "transparent") return true;
  if (color.starts_with('#'))
    return (color.size() == 5 || color.size() == 9) && color.ends_with(color.size() == 5 ? "0" : "00");
  const std::size_t open = color.find('('), alpha = color.find_last_of(",/");
  if (open == std::string::npos || alpha == std::string::npos) return false;
  const bool has_alpha = color[alpha] == '/' || std::ranges::count(color, ',') == 3;
  return has_alpha &&
         is_zero(std::string_view(color).substr(std::min(color.find_first_not_of(' ', alpha + 1), color.size())));
}

class StyleSheets {
 public:
  StyleSheets(const ptree& document, const std::string& name) : name_(name) { collect(document); }

  // Writes what the sheet says before the style of each element, which counts more; what is marked as important behind
  // it (CSS Cascading 3, 6).
  void write_inline(ptree& parent) const {
    for (auto& [tag, element] : parent) {
      if (tag == "<xmlattr>" || tag == "<xmlcomment>") continue;
      std::vector<const Rule*> matching;
      for (const Rule& rule : rules_)
        if (matches(rule, local_name(tag), element)) matching.push_back(&rule);
      std::ranges::stable_sort(matching, {}, &Rule::specificity);
      if (!matching.empty()) {
        std::string before, behind;
        for (const Rule* rule : matching)
          for (const auto& [key, text] : rule->declarations)
            (text.find("!important") == std::string::npos ? before : behind) += text + ";";
        element.put(ptree::path_type("<xmlattr>|style", '|'), before + attribute(element, "style") + ";" + behind);
      }
      write_inline(element);
    }
  }

 private:
  // They may stand anywhere.
  void collect(const ptree& parent) {
    for (const auto& [tag, element] : parent) {
      const std::string name = local_name(tag);
      if (name == "style") {
        std::string sheet = element.data();
        for (const auto& [inner, comment] : element)
          if (inner == "<xmlcomment>") sheet += comment.data();
        if (attribute(element, "media") != "print") read_sheet(std::move(sheet));
      }
      if (name == "link" && attribute(element, "rel") == "stylesheet") fail_svg(name_, "link", kSheetInOtherFile);
      if (tag != "<xmlattr>") collect(element);
    }
  }

  using Declarations = std::vector<std::pair<std::string, std::string>>;
  // Those that paint, and lengths; what shapes otherwise, and what has to be calculated, is refused.
  [[nodiscard]] Declarations declarations_of(std::string_view block) const {
    Declarations list;
    while (!block.empty()) {
      const std::size_t end = std::min(block.find(';'), block.size());
      const auto [key, value] = declaration(block.substr(0, end));
      if ((is_shape(key) && value != "none") || (is_length(key) && value.find('(') != std::string_view::npos) ||
          (is_paint(key) && value.starts_with("var(")))
        fail_svg(name_, "style",
                 fmt::format("the style sheet sets \"{}: {}\", which is not read; save the drawing with inline "
                             "styles (Illustrator: Styling \"Inline Style\")",
                             key, value.substr(0, 30)));
      if (is_paint(key) || is_length(key)) list.emplace_back(key, block.substr(0, end));
      block.remove_prefix(std::min(end + 1, block.size()));
    }
    return list;
  }

  // A rule of the sheet for one simple selector (Selectors 3, 5 … 6.4): a name of elements, classes and an id.
  struct Rule {
    std::string element, id;
    std::vector<std::string> classes;
    Declarations declarations;
    [[nodiscard]] std::array<std::size_t, 3> specificity() const {
      return {id.empty() ? 0U : 1U, classes.size(), element.empty() ? 0U : 1U};
    }
  };
  [[nodiscard]] Rule rule_of(std::string_view selector, const Declarations& declarations) const {
    Rule rule{{}, {}, {}, declarations};
    for (std::string_view rest = selector; !rest.empty();) {
      const char mark = rest.front();
      const bool is_marked = mark == '.' || mark == '#';
      const std::size_t end = std::min(rest.find_first_of(".#", is_marked ? 1 : 0), rest.size());
      std::string name(rest.substr(is_marked ? 1 : 0, end - (is_marked ? 1 : 0)));
      if (name.empty() || name.find_first_of(" \t\r\n>+~:[\\") != std::string::npos)
        fail_svg(name_, "style",
                 fmt::format("the style sheet has the selector \"{}\", which is not read; save the drawing with "
                             "inline styles (Illustrator: Styling \"Inline Style\")",
                             selector.substr(0, 40)));
      if (mark == '.')
        rule.classes.push_back(std::move(name));
      else if (mark == '#')
        rule.id = std::move(name);
      else if (name != "*")
        rule.element = std::move(name);
      rest.remove_prefix(end);
    }
    return rule;
  }

  void read_sheet(std::string sheet) {
    for (const auto& [open, close] : {std::pair{"/*", "*/"}, std::pair{"<!--", "-->"}}) {
      for (std::size_t from = sheet.find(open); from != std::string::npos; from = sheet.find(open)) {
        const std::size_t end = sheet.find(close, from);
        sheet.erase(from, end == std::string::npos ? end : end + std::string_view(close).size() - from);
      }
    }
    for (std::string_view rest = trimmed(sheet); !rest.empty(); rest = trimmed(rest)) {
      if (rest.starts_with("@import")) fail_svg(name_, "style", kSheetInOtherFile);
      const std::size_t open = rest.find_first_of(rest.starts_with('@') ? "{;" : "{");
      if (open == std::string_view::npos) return;
      if (rest[open] == ';') {  // @charset and @namespace
        rest.remove_prefix(open + 1);
        continue;
      }
      const std::string_view head = trimmed(rest.substr(0, open));
      std::size_t end = open + 1;
      for (int depth = 1; end < rest.size(); ++end) {
        depth += rest[end] == '{' ? 1 : rest[end] == '}' ? -1 : 0;
        if (depth == 0) break;
      }
      take_block(head, rest.substr(open + 1, end - open - 1));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  void take_block(std::string_view head, std::string_view block) {
    if (head.starts_with("@media print") || head.starts_with("@font-face") || head.starts_with("@page")) return;
    if (head.starts_with('@')) {  // Rules that hold under a condition.
      const std::string_view inner = block.substr(std::min(block.find('{') + 1, block.size()));
      if (!declarations_of(inner.substr(0, inner.find('}'))).empty())
        fail_svg(name_, "style",
                 fmt::format("the style sheet paints under the condition \"{}\", which is not read; save the "
                             "drawing with inline styles",
                             head.substr(0, 40)));
      return;
    }
    const Declarations declarations = declarations_of(block);
    if (declarations.empty()) return;
    for (std::string_view rest = head;;) {
      const std::size_t comma = rest.find(',');
      rules_.push_back(rule_of(trimmed(rest.substr(0, comma)), declarations));
      if (comma == std::string_view::npos) return;
      rest.remove_prefix(comma + 1);
    }
  }

  static bool matches(const Rule& rule, const std::string& name, const ptree& element) {
    const std::string classes = fmt::format(" {} ", attribute(element, "class"));
    return (rule.element.empty() || rule.element == name) && (rule.id.empty() || rule.id == attribute(element, "id")) &&
           std::ranges::all_of(rule.classes,
                               [&](const std::string& c) { return classes.find(" " + c + " ") != std::string::npos; });
  }

  const std::string& name_;
  std::vector<Rule> rules_;
};

}  // namespace

void fail_svg(const std::string& name, const std::string& where, const std::string& what) {
  throw InputError(fmt::format("{}: <{}>: {}", name, where, what));
}

std::string local_name(const std::string& name) {
  return name.substr(name.find(':') == std::string::npos ? 0 : name.find(':') + 1);
}

std::string attribute(const ptree& element, const char* name) {
  return element.get<std::string>(ptree::path_type(std::string("<xmlattr>|") + name, '|'), "");
}

std::string property(const ptree& element, const char* name) {
  const std::string style = attribute(element, "style");
  std::string value = attribute(element, name);
  for (std::string_view rest = style; !rest.empty();) {
    const std::size_t end = rest.find(';');
    const auto [key, given] = declaration(rest.substr(0, end));
    if (key == name) value = given;
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
  }
  return value;
}

bool is_length(std::string_view key) {
  constexpr std::array<std::string_view, 9> kLengths{"x", "y", "width", "height", "cx", "cy", "r", "rx", "ry"};
  return std::ranges::find(kLengths, key) != kLengths.end();
}

void apply_style_sheets(ptree& document, const std::string& name) {
  StyleSheets(document, name).write_inline(document);
}

Paint paint_of(const ptree& element, Paint paint) {
  constexpr std::array<const char*, 5> kNames{"fill", "stroke", "fill-opacity", "stroke-opacity", "visibility"};
  for (std::size_t k = 0; k < paint.size(); ++k) {
    const std::string own = property(element, kNames[k]);
    if (!own.empty() && own != "inherit") paint[k] = own;
  }
  return paint;
}
// A fill that nobody set is black, and a stroke is none.
bool is_painted(const Paint& paint, bool takes_unset_strokes) {
  const auto is_off = [&](std::size_t k) {
    return paint[k] == "none" || has_no_alpha(paint[k]) || is_zero(paint[k + 2]);
  };
  return !is_off(0) || ((takes_unset_strokes || !paint[1].empty()) && !is_off(1));
}
bool is_visible(const Paint& paint) {
  return paint[4] != "hidden" && paint[4] != "collapse";
}
bool is_displayed(const ptree& element) {
  return !is_zero(property(element, "opacity")) && property(element, "display") != "none";
}

}  // namespace triskin::placement
