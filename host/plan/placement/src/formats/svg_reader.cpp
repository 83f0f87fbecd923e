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
#include "svg_style.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/xml_depth.hpp"

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

class SvgReader {
 public:
  SvgReader(const std::string& text, const std::string& name, std::optional<double> unit_mm)
      : name_(name), outline_(name), unit_mm_(unit_mm) {
    if (text.find("<?xml-stylesheet") != std::string::npos) fail("?xml-stylesheet", kSheetInOtherFile);
    if (text.find("<!ENTITY") != std::string::npos)
      throw InputError(
          name_ +
          ": is an SVG with entities (<!ENTITY …>), which are not read; save it as plain SVG (Illustrator: "
          "without \"Preserve Illustrator Editing Capabilities\")");
    require_shallow_xml(text, name_);
    std::istringstream in(text);
    try {
      boost::property_tree::read_xml(in, document_);
    } catch (const boost::property_tree::xml_parser_error& e) {
      throw InputError(fmt::format("{}, line {}: is not well-formed XML; export the drawing again", name_, e.line()));
    }
  }

  Drawing read() {
    apply_style_sheets(document_, name_);
    collect_clips(document_);
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
    return {outline_.polygon(), remark()};
  }

 private:
  [[nodiscard]] const char* remark() const {
    if (has_size_)
      return "it has a width but no viewBox, so its numbers are pixels of 1/96 inch (SVG 2, 8.2); if they are "
             "millimetres, give --unit mm";
    if (is_in_pixels_)
      return "its lengths are pixels, taken as 96 an inch; for another scale (Illustrator means 72) give "
             "the drawing a width and height in mm, or --unit";
    return "";
  }

  [[noreturn]] void fail(const std::string& where, const std::string& what) const { fail_svg(name_, where, what); }

  // They may stand anywhere.
  void collect_clips(const ptree& parent) {
    for (const auto& [tag, element] : parent) {
      if (local_name(tag) == "clipPath") clips_["url(#" + attribute(element, "id") + ")"] = &element;
      if (tag != "<xmlattr>") collect_clips(element);
    }
  }

  void refuse_cut(const std::string& where, const ptree& element, const Eigen::Affine2d& place) const {
    for (const char* key : {"transform", "translate", "rotate", "scale", "d"}) {
      // The attributes "transform" and "d" are read, and "rotate" belongs to texts.
      const std::string value = property(element, key);
      if (!value.empty() && value != "none" && value != attribute(element, key))
        fail(where, fmt::format("its style sets \"{}: {}\", which is not read; write it as the attribute {}", key,
                                value.substr(0, 30), key == std::string_view("d") ? "d" : "transform"));
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

  // The width or height of the drawing. Pages give its style a share of the page, which is no size of the drawing.
  [[nodiscard]] std::string extent(const ptree& svg, const char* key) const {
    const std::string styled = property(svg, key);
    return length_mm(styled) ? styled : attribute(svg, key);
  }

  // User units to mm, y up: the drawing's height falls to y = 0.
  [[nodiscard]] Eigen::Affine2d to_mm(const ptree& svg) {
    const std::string wide = extent(svg, "width"), high = extent(svg, "height");
    const auto width = length_mm(wide), height = length_mm(high);
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
      is_in_pixels_ = is_pixels(width ? wide : high);
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
      has_size_ = width && !is_pixels(wide);
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
      if (!is_group && !is_painted(paint, takes_unset_strokes_)) {
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
    const std::string text = is_length(key) ? property(element, key) : attribute(element, key);
    if ((text.empty() || text == "auto") && fallback) return *fallback;
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
  std::optional<double> unit_mm_;
  bool is_in_pixels_ = false, has_size_ = false;
  int shapes_ = 0, unpainted_ = 0;
  bool takes_unset_strokes_ = false;
};

}  // namespace

Drawing outline_of_svg(const std::string& text, const std::string& name, std::optional<double> unit_mm) {
  return SvgReader(text, name, unit_mm).read();
}

}  // namespace triskin::placement
