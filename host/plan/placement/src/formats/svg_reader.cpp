// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <charconv>
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
  SvgReader(const std::string& text, const std::string& name) : name_(name), outline_(name) {
    std::istringstream in(text);
    try {
      boost::property_tree::read_xml(in, document_);
    } catch (const boost::property_tree::xml_parser_error& e) {
      throw InputError(fmt::format("{}, line {}: is not well-formed XML; export the drawing again", name_, e.line()));
    }
  }

  Polygon read() {
    for (const auto& [tag, element] : document_) {
      if (local_name(tag) != "svg") continue;
      children(element, to_mm(element), 0);
    }
    return outline_.polygon();
  }

 private:
  [[noreturn]] void fail(const std::string& where, const std::string& what) const {
    throw InputError(fmt::format("{}: <{}>: {}", name_, where, what));
  }

  static std::string attribute(const ptree& element, const char* name) {
    return element.get<std::string>(ptree::path_type(std::string("<xmlattr>|") + name, '|'), "");
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

  // User units to mm, y up: the drawing's height falls to y = 0.
  [[nodiscard]] Eigen::Affine2d to_mm(const ptree& svg) const {
    const auto width = length_mm(attribute(svg, "width")), height = length_mm(attribute(svg, "height"));
    Eigen::Affine2d place = Eigen::Affine2d::Identity();
    const std::string view_box = attribute(svg, "viewBox");
    Numbers box(view_box);
    const auto x = box.number(), y = box.number(), w = box.number(), h = box.number();
    if (x && y && w && h && *w > 0.0 && *h > 0.0) {
      // preserveAspectRatio: the smaller scale holds in both directions.
      double scale = kPx_mm;
      if (width && height)
        scale = std::min(*width / *w, *height / *h);
      else if (width)
        scale = *width / *w;
      else if (height)
        scale = *height / *h;
      place.scale(Vec2(scale, -scale));
      place.translate(Vec2(-*x, -*y - *h));
    } else {
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
    std::string style = attribute(element, "style");
    std::erase(style, ' ');
    const std::size_t opacity = style.find("opacity:0");  // also of fill and stroke: neither is shown
    const bool is_clear = attribute(element, "opacity") == "0" ||
                          (opacity != std::string::npos && (opacity == 0 || style[opacity - 1] == ';') &&
                           style.find_first_not_of("0.", opacity + 8) == style.find_first_of(";", opacity));
    return !is_clear && attribute(element, "display") != "none" && style.find("display:none") == std::string::npos &&
           attribute(element, "visibility") != "hidden" && style.find("visibility:hidden") == std::string::npos;
  }

  void children(const ptree& parent, const Eigen::Affine2d& place, int depth) {
    if (depth > kMaxDepth) fail("g", "groups are nested too deeply");
    for (const auto& [tag, element] : parent) {
      const std::string name = local_name(tag);
      if (!is_displayed(element)) continue;
      const Eigen::Affine2d own =
          name == "<xmlattr>" || name == "<xmlcomment>" ? place : place * transform_of(element, name);
      if (name == "g" || name == "a" || name == "switch") children(element, own, depth + 1);
      if (name == "svg" || name == "use")
        fail(name, "a drawing within the drawing is not read; ungroup it (in Inkscape: unlink clones)");
      if (name == "path") path(element, own);
      if (name == "rect") rectangle(element, own);
      if (name == "circle" || name == "ellipse") round(name, element, own);
      if (name == "polygon" || name == "polyline" || name == "line") straight(name, element, own);
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
    return unit.empty() || unit == "px" ? value : *length_mm(text) / kPx_mm;
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
};

}  // namespace

Polygon polygon_of_svg(const std::string& text, const std::string& name) {
  return SvgReader(text, name).read();
}

}  // namespace triskin::placement
