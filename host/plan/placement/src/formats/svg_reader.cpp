// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <charconv>
#include <map>
#include <numbers>
#include <optional>
#include <sstream>

#include "outline.hpp"
#include "triskin/base/error.hpp"

namespace triskin::placement {
namespace {

using boost::property_tree::ptree;

constexpr double kPx_mm = 25.4 / 96.0;  // CSS Values and Units 3, 5.2
constexpr int kMaxDepth = 100;

// Splits "10,20-3.5e1" into numbers, as the grammar of path data does: a sign or a second point begins a new number.
class Numbers {
 public:
  explicit Numbers(std::string_view text) : text_(text) {}

  // The next letter, or 0 where a number or the end follows.
  char letter() {
    skip();
    if (text_.empty() || std::isalpha(static_cast<unsigned char>(text_.front())) == 0) return 0;
    const char c = text_.front();
    text_.remove_prefix(1);
    return c;
  }
  [[nodiscard]] bool at_end() {
    skip();
    return text_.empty();
  }
  std::optional<double> number() {
    skip();
    if (text_.starts_with('+')) text_.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
    if (error != std::errc{} || !std::isfinite(value)) return std::nullopt;
    text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
    return value;
  }
  // A flag of an arc is one digit, which may touch what follows.
  std::optional<bool> flag() {
    skip();
    if (!text_.starts_with('0') && !text_.starts_with('1')) return std::nullopt;
    const bool is_set = text_.front() == '1';
    text_.remove_prefix(1);
    return is_set;
  }

 private:
  void skip() {
    const std::size_t from = text_.find_first_not_of(" \t\r\n,");
    text_.remove_prefix(from == std::string_view::npos ? text_.size() : from);
  }
  std::string_view text_;
};

std::string local_name(const std::string& name) {
  return name.substr(name.find(':') == std::string::npos ? 0 : name.find(':') + 1);
}

class SvgReader {
 public:
  SvgReader(const std::string& text, const std::string& name, std::optional<double> unit_mm)
      : name_(name), outline_(name), unit_mm_(unit_mm) {
    if (text.find("<?xml-stylesheet") != std::string::npos) fail("?xml-stylesheet", kOtherFile);
    if (text.find("<!ENTITY") != std::string::npos)
      throw InputError(
          name_ +
          ": is an SVG with entities (<!ENTITY …>), which are not read; save it as plain SVG (Illustrator: "
          "without \"Preserve Illustrator Editing Capabilities\")");
    std::istringstream in(text);
    try {
      boost::property_tree::read_xml(in, document_);
    } catch (const boost::property_tree::xml_parser_error& e) {
      throw InputError(fmt::format("{}, line {}: is not well-formed XML; export the drawing again", name_, e.line()));
    }
  }

  Drawing read() {
    collect(document_);
    write_inline(document_);
    for (const auto& [tag, element] : document_) {
      if (local_name(tag) != "svg") continue;
      page_ = to_mm(element);
      view_box_ = attribute(element, "viewBox");
      refuse_cut("svg", element, page_);
      children(element, page_, paint_of(element, {}), 0);
      if (shapes_ > 0 || unpainted_ == 0) continue;
      takes_unset_strokes_ = true;  // Some programs write outlines without a stroke.
      children(element, page_, paint_of(element, {}), 0);
    }
    return {outline_.polygon(),
            is_in_pixels_
                ? "its lengths are pixels, taken as 96 an inch; for another scale (Illustrator means 72) give "
                  "the drawing a width and height in mm, or --unit"
                : ""};
  }

 private:
  static constexpr const char* kOtherFile =
      "the style sheet is in another file, which is not read; save the drawing with inline styles, or as plain SVG";

  [[noreturn]] void fail(const std::string& where, const std::string& what) const {
    throw InputError(fmt::format("{}: <{}>: {}", name_, where, what));
  }

  static std::string attribute(const ptree& element, const char* name) {
    return element.get<std::string>(ptree::path_type(std::string("<xmlattr>|") + name, '|'), "");
  }

  // The value of a property: one in the style counts before the attribute (SVG 2, 6.6).
  static std::string property(const ptree& element, const char* name) {
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
  static std::string_view trimmed(std::string_view s) {
    const std::size_t from = s.find_first_not_of(" \t\r\n");
    return from == std::string_view::npos ? std::string_view()
                                          : s.substr(from, s.find_last_not_of(" \t\r\n") + 1 - from);
  }
  // "display: none !important" in two.
  static std::pair<std::string_view, std::string_view> declaration(std::string_view text) {
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) return {};
    const std::string_view value = text.substr(colon + 1);
    return {trimmed(text.substr(0, colon)), trimmed(value.substr(0, value.find('!')))};
  }
  static bool is_zero(std::string_view text) {
    double value = 1.0;
    (void)std::from_chars(text.data(), text.data() + text.size(), value);
    return value == 0.0;
  }

  // Style sheets and clip paths may stand anywhere.
  void collect(const ptree& parent) {
    for (const auto& [tag, element] : parent) {
      const std::string name = local_name(tag);
      if (name == "style") {
        std::string sheet = element.data();
        for (const auto& [inner, comment] : element)
          if (inner == "<xmlcomment>") sheet += comment.data();
        if (attribute(element, "media") != "print") read_sheet(std::move(sheet));
      }
      if (name == "link" && attribute(element, "rel") == "stylesheet") fail("link", kOtherFile);
      if (name == "clipPath") clips_["url(#" + attribute(element, "id") + ")"] = &element;
      if (tag != "<xmlattr>") collect(element);
    }
  }

  // What decides whether a shape belongs to the outline.
  static bool is_paint(std::string_view key) {
    constexpr std::array<std::string_view, 7> kPaint{"fill",    "stroke",  "fill-opacity", "stroke-opacity",
                                                     "opacity", "display", "visibility"};
    return std::ranges::find(kPaint, key) != kPaint.end();
  }
  // What moves, cuts or shapes it.
  static bool is_shape(std::string_view key) {
    constexpr std::array<std::string_view, 15> kShape{"transform", "translate", "rotate", "scale", "clip-path",
                                                      "mask",      "d",         "x",      "y",     "cx",
                                                      "cy",        "r",         "rx",     "ry",    "points"};
    return std::ranges::find(kShape, key) != kShape.end();
  }
  using Declarations = std::vector<std::pair<std::string, std::string>>;
  // Those of the keys above; ones that shape are refused.
  [[nodiscard]] Declarations declarations_of(std::string_view block) const {
    Declarations list;
    while (!block.empty()) {
      const std::size_t end = std::min(block.find(';'), block.size());
      const auto [key, value] = declaration(block.substr(0, end));
      if ((is_shape(key) && value != "none") || (is_paint(key) && value.starts_with("var(")))
        fail("style", fmt::format("the style sheet sets \"{}: {}\", which is not read; save the drawing with inline "
                                  "styles (Illustrator: Styling \"Inline Style\")",
                                  key, value.substr(0, 30)));
      if (is_paint(key)) list.emplace_back(key, block.substr(0, end));
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
        fail("style", fmt::format("the style sheet has the selector \"{}\", which is not read; save the drawing with "
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
      if (rest.starts_with("@import")) fail("style", kOtherFile);
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
        fail("style", fmt::format("the style sheet paints under the condition \"{}\", which is not read; save the "
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
  static bool matches(const Rule& rule, const std::string& name, const ptree& element) {
    const std::string classes = " " + attribute(element, "class") + " ";
    return (rule.element.empty() || rule.element == name) && (rule.id.empty() || rule.id == attribute(element, "id")) &&
           std::ranges::all_of(rule.classes,
                               [&](const std::string& c) { return classes.find(" " + c + " ") != std::string::npos; });
  }

  void refuse_cut(const std::string& where, const ptree& element, const Eigen::Affine2d& place) const {
    for (const char* key : {"transform", "translate", "rotate", "scale"}) {
      // The attribute "transform" is read, and "rotate" belongs to texts.
      const std::string value = property(element, key);
      if (!value.empty() && value != "none" && value != attribute(element, key))
        fail(where, fmt::format("its style sets \"{}: {}\", which is not read; write it as the attribute transform",
                                key, value.substr(0, 30)));
    }
    for (const char* key : {"clip-path", "mask"}) {
      const std::string value = property(element, key);
      if (!value.empty() && value != "none" && !is_whole_page(value, place))
        fail(where,
             fmt::format("is cut by a {}, which is not read; release it, and cut the shape itself (Inkscape: Path "
                         "> Intersection)",
                         key));
    }
  }
  // LibreOffice and converters of PDF clip all to a rectangle as large as the drawing.
  [[nodiscard]] bool is_whole_page(const std::string& clip, const Eigen::Affine2d& place) const {
    const auto found = clips_.find(clip);
    if (found == clips_.end() || !place.isApprox(page_)) return false;
    const ptree& path = *found->second;
    Numbers box(view_box_);
    const auto x = box.number(), y = box.number(), w = box.number(), h = box.number();
    const auto rect = path.find("rect");
    if (!x || !y || !w || !h || rect == path.not_found() || path.count("rect") != 1) return false;
    const bool is_plain = attribute(path, "clipPathUnits") != "objectBoundingBox" &&
                          attribute(path, "transform").empty() && attribute(path, "clip-path").empty() &&
                          attribute(rect->second, "transform").empty() && attribute(rect->second, "style").empty() &&
                          attribute(rect->second, "rx").empty() && attribute(rect->second, "ry").empty();
    if (!is_plain) return false;
    const double left = number(rect->second, "x", "rect"), top = number(rect->second, "y", "rect");
    return left <= *x && top <= *y && left + number(rect->second, "width", "rect", {}) >= *x + *w &&
           top + number(rect->second, "height", "rect", {}) >= *y + *h;
  }

  // What paints a shape, as groups hand it down (SVG 2, 13): fill, stroke, the opacity of each, and visibility.
  using Paint = std::array<std::string, 5>;
  static Paint paint_of(const ptree& element, Paint paint) {
    constexpr std::array<const char*, 5> kNames{"fill", "stroke", "fill-opacity", "stroke-opacity", "visibility"};
    for (std::size_t k = 0; k < paint.size(); ++k) {
      const std::string own = property(element, kNames[k]);
      if (!own.empty() && own != "inherit") paint[k] = own;
    }
    return paint;
  }
  // A fill that nobody set is black, and a stroke is none.
  [[nodiscard]] bool is_painted(const Paint& paint) const {
    const auto is_off = [&](std::size_t k) {
      return paint[k] == "none" || has_no_alpha(paint[k]) || is_zero(paint[k + 2]);
    };
    return !is_off(0) || ((takes_unset_strokes_ || !paint[1].empty()) && !is_off(1));
  }
  static bool is_visible(const Paint& paint) { return paint[4] != "hidden" && paint[4] != "collapse"; }
  // transparent, #rgb0, #rrggbb00, rgba(…, 0) and hsla(…, 0), rgb(… / 0%) (CSS Color 4).
  static bool has_no_alpha(const std::string& color) {
    if (color == "transparent") return true;
    if (color.starts_with('#'))
      return (color.size() == 5 || color.size() == 9) && color.ends_with(color.size() == 5 ? "0" : "00");
    const std::size_t open = color.find('('), alpha = color.find_last_of(",/");
    if (open == std::string::npos || alpha == std::string::npos) return false;
    const bool has_alpha = color[alpha] == '/' || std::ranges::count(color, ',') == 3;
    return has_alpha &&
           is_zero(std::string_view(color).substr(std::min(color.find_first_not_of(' ', alpha + 1), color.size())));
  }

  // A length in mm; nothing for one in per cent or without a number.
  [[nodiscard]] std::optional<double> length_mm(const std::string& text) const {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{}) return std::nullopt;
    const std::string unit(end, text.data() + text.size());
    if (unit.empty() || unit == "px") return kPx_mm * value;
    if (unit == "mm") return value;
    if (unit == "cm") return 10.0 * value;
    if (unit == "in") return 25.4 * value;
    if (unit == "pt") return 25.4 / 72.0 * value;
    if (unit == "pc") return 25.4 / 6.0 * value;
    if (unit == "Q") return 0.25 * value;
    if (unit == "%") return std::nullopt;
    fail("svg", fmt::format("\"{}\" is no length that is known; give mm", text.substr(0, 30)));
  }

  static bool is_pixels(const std::string& length) {
    return length.ends_with("px") || (!length.empty() && std::isdigit(static_cast<unsigned char>(length.back())) != 0);
  }

  // User units to mm, y up: the drawing's height falls to y = 0.
  [[nodiscard]] Eigen::Affine2d to_mm(const ptree& svg) {
    const auto width = length_mm(attribute(svg, "width")), height = length_mm(attribute(svg, "height"));
    Eigen::Affine2d place = Eigen::Affine2d::Identity();
    const std::string view_box = attribute(svg, "viewBox");
    Numbers box(view_box);
    const auto x = box.number(), y = box.number(), w = box.number(), h = box.number();
    const bool has_box = x && y && w && h && *w > 0.0 && *h > 0.0;
    if (unit_mm_) {
      place.scale(*unit_mm_ * Vec2(1.0, -1.0));
      if (has_box) place.translate(Vec2(-*x, -*y - *h));
    } else if (has_box) {
      if (!width && !height)
        fail("svg",
             "does not say how large it is; give it width and height in mm, width=\"150mm\" say, beside its "
             "viewBox; or pass --unit");
      is_in_pixels_ = is_pixels(attribute(svg, width ? "width" : "height"));
      const double across = width ? *width / *w : *height / *h, up = height ? *height / *h : across;
      const std::string fit = attribute(svg, "preserveAspectRatio");
      if (fit.find("slice") != std::string::npos && std::abs(across - up) > 1e-9 * across)
        fail("svg",
             "preserveAspectRatio=\"… slice\" cuts the drawing at its edge, which is not read; give width and "
             "height the ratio of the viewBox");
      // The smaller scale holds in both directions, unless each has its own.
      if (fit.starts_with("none"))
        place.scale(Vec2(across, -up));
      else
        place.scale(std::min(across, up) * Vec2(1.0, -1.0));
      place.translate(Vec2(-*x, -*y - *h));
    } else {
      is_in_pixels_ = true;
      place.scale(Vec2(kPx_mm, -kPx_mm));
      if (height) place.translate(Vec2(0.0, -*height / kPx_mm));
    }
    return place;
  }

  [[nodiscard]] Eigen::Affine2d transform_of(const ptree& element, const std::string& where) const {
    const std::string text = attribute(element, "transform");
    Eigen::Affine2d all = Eigen::Affine2d::Identity();
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t open = text.find('(', at);
      if (open == std::string::npos) break;
      const std::size_t close = text.find(')', open);
      if (close == std::string::npos) fail(where, "its transform is not closed");
      std::string kind = text.substr(at, open - at);
      std::erase_if(kind, [](char c) { return c == ' ' || c == ',' || c == '\n' || c == '\t' || c == '\r'; });
      const std::string inside = text.substr(open + 1, close - open - 1);
      Numbers numbers(inside);
      std::vector<double> v;
      while (const auto value = numbers.number()) v.push_back(*value);
      Eigen::Affine2d one = Eigen::Affine2d::Identity();
      const auto need = [&](std::size_t low, std::size_t high) {
        if (v.size() < low || v.size() > high)
          fail(where, fmt::format("its transform {} has {} numbers", kind, v.size()));
      };
      if (kind == "matrix") {
        need(6, 6);
        one.matrix() << v[0], v[2], v[4], v[1], v[3], v[5], 0.0, 0.0, 1.0;
      } else if (kind == "translate") {
        need(1, 2);
        one.translate(Vec2(v[0], v.size() > 1 ? v[1] : 0.0));
      } else if (kind == "scale") {
        need(1, 2);
        one.scale(Vec2(v[0], v.back()));
      } else if (kind == "rotate") {
        need(1, 3);
        const Vec2 about = v.size() == 3 ? Vec2(v[1], v[2]) : Vec2(0.0, 0.0);
        one.translate(about);
        one.rotate(v[0] * std::numbers::pi / 180.0);
        one.translate(-about);
      } else if (kind == "skewX" || kind == "skewY") {
        need(1, 1);
        one.matrix()(kind == "skewX" ? 0 : 1, kind == "skewX" ? 1 : 0) = std::tan(v[0] * std::numbers::pi / 180.0);
      } else {
        fail(where, fmt::format("the transform \"{}\" is not known", kind.substr(0, 20)));
      }
      all = all * one;
      at = close + 1;
    }
    return all;
  }

  static bool is_displayed(const ptree& element) {
    return !is_zero(property(element, "opacity")) && property(element, "display") != "none";
  }

  void children(const ptree& parent, const Eigen::Affine2d& place, const Paint& inherited, int depth) {
    if (depth > kMaxDepth) fail("g", "groups are nested too deeply");
    for (const auto& [tag, element] : parent) {
      const std::string name = local_name(tag);
      if (name == "<xmlattr>" || name == "<xmlcomment>" || !is_displayed(element)) continue;
      const bool is_group = name == "g" || name == "a" || name == "switch";
      const bool is_round = name == "circle" || name == "ellipse";
      const bool is_straight = name == "polygon" || name == "polyline" || name == "line";
      if (name == "svg" || name == "use")
        fail(name, "a drawing within the drawing is not read; ungroup it (in Inkscape: unlink clones)");
      if (!is_group && !is_round && !is_straight && name != "path" && name != "rect") continue;
      const Paint paint = paint_of(element, inherited);
      if (!is_group && !is_visible(paint)) continue;
      if (!is_group && !is_painted(paint)) {
        ++unpainted_;
        continue;
      }
      shapes_ += is_group ? 0 : 1;
      refuse_cut(name, element, place);
      const Eigen::Affine2d own = place * transform_of(element, name);
      if (is_group) children(element, own, paint, depth + 1);
      if (name == "path") path(element, own);
      if (name == "rect") rectangle(element, own);
      if (is_round) round(name, element, own);
      if (is_straight) straight(name, element, own);
    }
  }

  [[nodiscard]] double number(const ptree& element, const char* key, const std::string& where,
                              std::optional<double> fallback = 0.0) const {
    const std::string text = attribute(element, key);
    if (text.empty() && fallback) return *fallback;
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string unit(end, text.data() + text.size());
    if (error != std::errc{} || unit == "%")
      fail(where, fmt::format("{}=\"{}\" is no number", key, text.substr(0, 20)));
    return unit.empty() || unit == "px" ? value : *length_mm(text) / unit_mm_.value_or(kPx_mm);
  }

  void rectangle(const ptree& e, const Eigen::Affine2d& place) {
    const double x = number(e, "x", "rect"), y = number(e, "y", "rect");
    const double w = number(e, "width", "rect", {}), h = number(e, "height", "rect", {});
    // One radius that is missing is the other.
    double rx = number(e, "rx", "rect", -1.0), ry = number(e, "ry", "rect", -1.0);
    if (rx < 0.0) rx = std::max(ry, 0.0);
    if (ry < 0.0) ry = rx;
    rx = std::min(rx, 0.5 * w);
    ry = std::min(ry, 0.5 * h);
    outline_.move_to(place * Vec2(x + rx, y));
    const std::array<Vec2, 4> middles{Vec2(x + w - rx, y + ry), Vec2(x + w - rx, y + h - ry), Vec2(x + rx, y + h - ry),
                                      Vec2(x + rx, y + ry)};
    for (std::size_t k = 0; k < 4; ++k) {
      const double from = (static_cast<double>(k) - 1.0) * 0.5 * std::numbers::pi;
      outline_.line_to(place * (middles[k] + Vec2(rx * std::cos(from), ry * std::sin(from))));
      if (rx > 0.0 && ry > 0.0)
        outline_.arc(place * middles[k], place.linear() * Vec2(rx, 0.0), place.linear() * Vec2(0.0, ry), from,
                     0.5 * std::numbers::pi, false);
    }
    outline_.close();
  }

  void round(const std::string& name, const ptree& e, const Eigen::Affine2d& place) {
    const bool is_circle = name == "circle";
    const double rx = number(e, is_circle ? "r" : "rx", name, {}), ry = is_circle ? rx : number(e, "ry", name, {});
    outline_.arc(place * Vec2(number(e, "cx", name), number(e, "cy", name)), place.linear() * Vec2(rx, 0.0),
                 place.linear() * Vec2(0.0, ry), 0.0, 2.0 * std::numbers::pi, true);
    outline_.close();
  }

  void straight(const std::string& name, const ptree& e, const Eigen::Affine2d& place) {
    if (name == "line") {
      outline_.move_to(place * Vec2(number(e, "x1", name), number(e, "y1", name)));
      return outline_.line_to(place * Vec2(number(e, "x2", name), number(e, "y2", name)));
    }
    const std::string text = attribute(e, "points");
    Numbers numbers(text);
    bool begins = true;
    while (!numbers.at_end()) {
      const auto x = numbers.number(), y = numbers.number();
      if (!x || !y) fail(name, "its points are not pairs of numbers");
      const Vec2 p = place * Vec2(*x, *y);
      begins ? outline_.move_to(p) : outline_.line_to(p);
      begins = false;
    }
    if (name == "polygon" && !begins) outline_.close();
  }

  // SVG 2, 9.3: a small letter takes points relative to the current one; numbers that go on repeat the letter.
  void path(const ptree& e, const Eigen::Affine2d& place) {
    const std::string data = attribute(e, "d");
    Numbers d(data);
    Vec2 now(0, 0), start(0, 0), last_control(0, 0);
    char command = 0, before = 0;
    bool is_open = false;
    const auto number = [&]() {
      const auto value = d.number();
      if (!value) fail("path", fmt::format("a number is missing behind \"{}\" in d", command));
      return *value;
    };
    while (!d.at_end()) {
      if (const char letter = d.letter(); letter != 0)
        command = letter;
      else if (command == 0 || command == 'Z' || command == 'z')
        fail("path", "d does not begin with a command");
      else if (command == 'M' || command == 'm')
        command = command == 'M' ? 'L' : 'l';
      const bool is_relative = std::islower(static_cast<unsigned char>(command)) != 0;
      const char kind = static_cast<char>(std::toupper(static_cast<unsigned char>(command)));
      const auto point = [&]() {
        const double x = number();
        const Vec2 p(x, number());
        return is_relative ? Vec2(now + p) : p;
      };
      if (kind == 'M') {
        now = start = point();
        outline_.move_to(place * now);
        is_open = true;
        before = kind;
        continue;
      }
      if (!is_open) {  // After Z the next curve begins where the closed one did.
        outline_.move_to(place * now);
        is_open = true;
      }
      const auto mirrored = [&](const char* after) {
        return std::string_view(after).find(before) != std::string_view::npos && before != 0
                   ? Vec2(2.0 * now - last_control)
                   : now;
      };
      if (kind == 'Z') {
        outline_.close();
        now = start;
        is_open = false;
      } else if (kind == 'L') {
        now = point();
        outline_.line_to(place * now);
      } else if (kind == 'H' || kind == 'V') {
        double& coordinate = kind == 'H' ? now.x() : now.y();
        coordinate = number() + (is_relative ? coordinate : 0.0);
        outline_.line_to(place * now);
      } else if (kind == 'C' || kind == 'S') {
        const Vec2 a = kind == 'C' ? point() : mirrored("CS");
        last_control = point();
        now = point_after(a, last_control, point(), place);
      } else if (kind == 'Q' || kind == 'T') {
        const Vec2 control = kind == 'Q' ? point() : mirrored("QT"), p = point();
        const Vec2 from = now;
        last_control = control;
        now = point_after(from + 2.0 / 3.0 * (control - from), p + 2.0 / 3.0 * (control - p), p, place);
      } else if (kind == 'A') {
        const double rx = std::abs(number()), ry = std::abs(number()), turn = number() * std::numbers::pi / 180.0;
        const auto is_large = d.flag(), is_positive = d.flag();
        if (!is_large || !is_positive) fail("path", "a flag of an arc in d is neither 0 nor 1");
        const Vec2 p = point();
        elliptic_arc(now, p, rx, ry, turn, *is_large, *is_positive, place);
        now = p;
      } else {
        fail("path", fmt::format("\"{}\" is no command of d", command));
      }
      before = kind;
    }
  }
  Vec2 point_after(const Vec2& a, const Vec2& b, const Vec2& p, const Eigen::Affine2d& place) {
    outline_.cubic_to(place * a, place * b, place * p);
    return p;
  }

  // From end points to centre: SVG 2, B.2.4.
  void elliptic_arc(const Vec2& from, const Vec2& to, double rx, double ry, double turn, bool is_large,
                    bool is_positive, const Eigen::Affine2d& place) {
    if (rx == 0.0 || ry == 0.0 || from == to) return outline_.line_to(place * to);
    const Eigen::Rotation2Dd rotation(turn);
    const Vec2 half = rotation.inverse() * Vec2(0.5 * (from - to));
    const double spread = half.x() * half.x() / (rx * rx) + half.y() * half.y() / (ry * ry);
    if (spread > 1.0) {
      rx *= std::sqrt(spread);
      ry *= std::sqrt(spread);
    }
    const double low = rx * rx * half.y() * half.y() + ry * ry * half.x() * half.x();
    const double root =
        std::sqrt(std::max(0.0, (rx * rx * ry * ry - low) / low)) * (is_large == is_positive ? -1.0 : 1.0);
    const Vec2 centre(root * rx * half.y() / ry, -root * ry * half.x() / rx);
    const double a = std::atan2((half.y() - centre.y()) / ry, (half.x() - centre.x()) / rx);
    double sweep = std::atan2((-half.y() - centre.y()) / ry, (-half.x() - centre.x()) / rx) - a;
    if (is_positive && sweep < 0.0) sweep += 2.0 * std::numbers::pi;
    if (!is_positive && sweep > 0.0) sweep -= 2.0 * std::numbers::pi;
    const Vec2 middle = rotation * centre + 0.5 * (from + to);
    outline_.arc(place * middle, place.linear() * (rotation * Vec2(rx, 0.0)),
                 place.linear() * (rotation * Vec2(0.0, ry)), a, sweep, false);
  }

  const std::string& name_;
  Outline outline_;
  ptree document_;
  Eigen::Affine2d page_ = Eigen::Affine2d::Identity();
  std::string view_box_;
  std::map<std::string, const ptree*> clips_;  // by the reference to them: url(#id)
  std::vector<Rule> rules_;
  std::optional<double> unit_mm_;
  bool is_in_pixels_ = false;
  int shapes_ = 0, unpainted_ = 0;
  bool takes_unset_strokes_ = false;
};

}  // namespace

Drawing outline_of_svg(const std::string& text, const std::string& name, std::optional<double> unit_mm) {
  return SvgReader(text, name, unit_mm).read();
}

}  // namespace triskin::placement
