// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "outline.hpp"
#include "triskin/base/error.hpp"

namespace triskin::placement {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// One pair of lines: what the value means, and the value.
struct Group {
  int code = 0;
  std::string_view value;
  std::size_t line = 0;
};

struct Entity {
  std::string kind;
  std::size_t line = 0;
  std::vector<Group> groups;
};

std::string_view trimmed(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \t\r");
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(" \t\r") + 1 - from);
}

// Names of layers are the same in upper and lower case.
std::string upper_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

// The reference of the format is AutoCAD's "DXF Reference"; entities lie in the plane z = 0.
class DxfReader {
 public:
  DxfReader(const std::string& text, const std::string& name, std::optional<double> unit_mm)
      : name_(name), outline_(name), given_mm_(unit_mm), unit_mm_(unit_mm.value_or(1.0)) {
    split(text);
  }

  Drawing read() {
    std::string section;
    for (std::size_t k = 0; k < groups_.size(); ++k) {
      if (groups_[k].code != 0) continue;
      Entity entity{std::string(groups_[k].value), groups_[k].line, {}};
      while (k + 1 < groups_.size() && groups_[k + 1].code != 0) entity.groups.push_back(groups_[++k]);
      if (entity.kind == "SECTION") {
        section = text_of(entity, 2);
        // The header's variables are no entities.
        if (section == "HEADER") {
          for (std::size_t v = 0; v < entity.groups.size(); ++v) variable(entity.groups, v);
        }
      }
      if (entity.kind == "ENDSEC") section.clear();
      if (section == "TABLES" && entity.kind == "LAYER") layer(entity);
      if (section == "ENTITIES") take(entity);
    }
    if (!unread_.empty() && !has_curves_) {
      std::string list;
      for (const std::string& kind : unread_) list += (list.empty() ? "" : ", ") + kind;
      fail(0, fmt::format("holds no curve that is read, but {}; explode blocks, and draw the outline as lines, arcs, "
                          "polylines or splines",
                          list));
    }
    const bool is_said = given_mm_ || says_unit_;
    return {outline_.polygon(),
            is_said ? "" : "the drawing names no unit; its numbers are taken as millimetres, --unit names another"};
  }

 private:
  [[noreturn]] void fail(std::size_t line, const std::string& what) const {
    throw InputError(line > 0 ? fmt::format("{}, line {}: {}", name_, line, what) : fmt::format("{}: {}", name_, what));
  }

  void split(std::string_view text) {
    std::size_t line = 0;
    const auto next = [&]() -> std::optional<std::string_view> {
      if (text.empty()) return std::nullopt;
      const std::size_t end = text.find('\n');
      const std::string_view found = trimmed(text.substr(0, end));
      text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
      ++line;
      return found;
    };
    while (const auto code = next()) {
      if (code->empty() && text.empty()) break;
      Group group;
      group.line = line;
      const auto [end, error] = std::from_chars(code->data(), code->data() + code->size(), group.code);
      if (error != std::errc{} || end != code->data() + code->size())
        fail(line, fmt::format("\"{}\" is no group code; the drawing is damaged", code->substr(0, 20)));
      const auto value = next();
      if (!value) fail(line, "the file ends within a group: it was cut");
      group.value = *value;
      if (group.code == 999) continue;  // A comment.
      groups_.push_back(group);
      if (group.code == 0 && group.value == "EOF") return;
    }
    fail(line, "the file ends without EOF: it was cut");
  }

  void variable(const std::vector<Group>& groups, std::size_t k) {
    if (groups[k].code != 9 || groups[k].value != "$INSUNITS" || k + 1 >= groups.size()) return;
    const int unit = static_cast<int>(number(groups[k + 1]));
    says_unit_ = unit != 0;
    if (!says_unit_ || given_mm_) return;
    static const std::map<int, double> kUnits_mm{{1, 25.4},    {2, 304.8},  {4, 1.0},    {5, 10.0},  {6, 1000.0},
                                                 {8, 2.54e-5}, {9, 0.0254}, {10, 914.4}, {13, 1e-3}, {14, 100.0}};
    const auto found = kUnits_mm.find(unit);
    if (found == kUnits_mm.end())
      fail(groups[k + 1].line, fmt::format("$INSUNITS {} is no unit of a part; draw it in millimetres (4)", unit));
    unit_mm_ = found->second;
  }

  [[nodiscard]] double number(const Group& group) const {
    double value = 0.0;
    const char* from = group.value.data() + (group.value.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(from, group.value.data() + group.value.size(), value);
    if (error != std::errc{} || end != group.value.data() + group.value.size() || !std::isfinite(value))
      fail(group.line, fmt::format("\"{}\" is no number", group.value.substr(0, 20)));
    return value;
  }
  [[nodiscard]] double value(const Entity& e, int code, double fallback) const {
    for (const Group& g : e.groups) {
      if (g.code == code) return number(g);
    }
    return fallback;
  }
  [[nodiscard]] double value(const Entity& e, int code) const {
    for (const Group& g : e.groups) {
      if (g.code == code) return number(g);
    }
    fail(e.line, fmt::format("{} lacks its group {}", e.kind, code));
  }
  static std::string text_of(const Entity& e, int code) {
    for (const Group& g : e.groups) {
      if (g.code == code) return std::string(g.value);
    }
    return {};
  }
  // All values of a code, in order.
  [[nodiscard]] std::vector<double> values(const Entity& e, int code) const {
    std::vector<double> list;
    for (const Group& g : e.groups) {
      if (g.code == code) list.push_back(number(g));
    }
    return list;
  }

  // A negative colour switches a layer off; bit 0 of its flags freezes it.
  void layer(const Entity& e) {
    const bool is_frozen = (static_cast<int>(value(e, 70, 0.0)) & 1) != 0;
    if (value(e, 62, 7.0) < 0.0 || is_frozen) off_layers_.insert(upper_case(text_of(e, 2)));
  }

  void take(const Entity& e) {
    if (e.kind == "SECTION") return;
    if (e.kind == "VERTEX" && polyline_) return vertex(e);
    if (e.kind == "SEQEND" && polyline_) return end_polyline();
    const bool is_shown =
        !off_layers_.contains(upper_case(text_of(e, 8))) && value(e, 60, 0.0) == 0.0 && value(e, 67, 0.0) == 0.0;
    if (e.kind == "POLYLINE") {
      begin_polyline(e, is_shown);
      return;
    }
    if (!is_shown) return;
    take_plane(e);
    has_curves_ = true;
    if (e.kind == "LINE") {
      if (unit_mm_ * std::abs(value(e, 30, 0.0) - value(e, 31, 0.0)) > kJoined_mm) fail_tilted(e.line, e.kind);
      outline_.move_to(unit_mm_ * Vec2(value(e, 10), value(e, 20)));
      outline_.line_to(unit_mm_ * Vec2(value(e, 11), value(e, 21)));
    } else if (e.kind == "LWPOLYLINE") {
      lightweight(e);
    } else if (e.kind == "CIRCLE") {
      round(e, 0.0, 360.0);
      outline_.close();
    } else if (e.kind == "ARC") {
      const double from = value(e, 50), to = value(e, 51);
      round(e, from, to > from ? to : to + 360.0);
    } else if (e.kind == "ELLIPSE") {
      ellipse(e);
    } else if (e.kind == "SPLINE") {
      spline(e);
    } else if (e.kind == "INSERT" || e.kind == "REGION" || e.kind == "MLINE" || e.kind == "3DSOLID") {
      fail(e.line, fmt::format("{} is not read; explode it in the drawing into lines, arcs and polylines", e.kind));
    } else {  // Texts, dimensions, hatches and the like are no outline.
      has_curves_ = had_curves_;
      unread_.insert(e.kind);
    }
    had_curves_ = has_curves_;
  }

  void take_plane(const Entity& e) {
    const double extrusion = value(e, 230, 1.0);
    if (std::abs(std::abs(extrusion) - 1.0) > 1e-6) fail_tilted(e.line, e.kind);
    flip_ = extrusion < 0.0 ? -1.0 : 1.0;
  }
  [[noreturn]] void fail_tilted(std::size_t line, const std::string& kind) const {
    fail(line, fmt::format("{} lies in a plane that is tilted; draw the outline in the plane z = 0", kind));
  }

  // Coordinates of plane entities are those of a system whose x turns with the extrusion.
  [[nodiscard]] Vec2 plane(double x, double y) const { return unit_mm_ * Vec2(flip_ * x, y); }

  void round(const Entity& e, double from_deg, double to_deg) {
    const double radius = unit_mm_ * value(e, 40);
    outline_.arc(plane(value(e, 10), value(e, 20)), Vec2(flip_ * radius, 0.0), Vec2(0.0, radius), from_deg * kDegree,
                 (to_deg - from_deg) * kDegree, true);
  }

  void ellipse(const Entity& e) {
    const Vec2 middle = unit_mm_ * Vec2(value(e, 10), value(e, 20)), u = unit_mm_ * Vec2(value(e, 11), value(e, 21));
    const double ratio = value(e, 40), from = value(e, 41, 0.0);
    double to = value(e, 42, 2.0 * std::numbers::pi);
    if (to <= from) to += 2.0 * std::numbers::pi;
    outline_.arc(middle, u, flip_ * ratio * Vec2(-u.y(), u.x()), from, to - from, true);
    if (to - from > 2.0 * std::numbers::pi - 1e-9) outline_.close();
  }

  struct Corner {
    Vec2 at;
    double bulge = 0.0;
  };

  void lightweight(const Entity& e) {
    std::vector<Corner> corners;
    double x = 0.0;
    for (const Group& g : e.groups) {
      if (g.code == 10) x = number(g);
      if (g.code == 20) corners.push_back({plane(x, number(g))});
      if (g.code == 42 && !corners.empty()) corners.back().bulge = flip_ * number(g);
    }
    polyline(corners, (static_cast<int>(value(e, 70, 0.0)) & 1) != 0);
  }

  void begin_polyline(const Entity& e, bool is_shown) {
    constexpr int kClosed = 1, kMeshes = 16 | 64;
    const int flags = static_cast<int>(value(e, 70, 0.0));
    polyline_ = OpenPolyline{{}, (flags & kClosed) != 0, is_shown && (flags & kMeshes) == 0};
    if (polyline_->is_shown) take_plane(e);
  }
  void vertex(const Entity& e) {
    constexpr int kControlPoint = 16;  // Of a curve that was fitted; the curve's own points follow.
    if ((static_cast<int>(value(e, 70, 0.0)) & kControlPoint) != 0) return;
    const double z = value(e, 30, 0.0);
    if (polyline_->corners.empty()) polyline_->z = z;
    if (polyline_->is_shown && unit_mm_ * std::abs(z - polyline_->z) > kJoined_mm) fail_tilted(e.line, "POLYLINE");
    polyline_->corners.push_back({plane(value(e, 10), value(e, 20)), flip_ * value(e, 42, 0.0)});
  }
  void end_polyline() {
    if (polyline_->is_shown) {
      polyline(polyline_->corners, polyline_->is_closed);
      has_curves_ = had_curves_ = true;
    }
    polyline_.reset();
  }

  // A bulge is the tangent of a quarter of the arc's angle, positive to the left of the chord.
  void polyline(const std::vector<Corner>& corners, bool is_closed) {
    if (corners.size() < 2) return;
    outline_.move_to(corners[0].at);
    const std::size_t sides = is_closed ? corners.size() : corners.size() - 1;
    for (std::size_t k = 0; k < sides; ++k) {
      const Vec2 a = corners[k].at, b = corners[(k + 1) % corners.size()].at;
      const double bulge = corners[k].bulge;
      if (std::abs(bulge) < 1e-12 || a == b) {
        outline_.line_to(b);
        continue;
      }
      const Vec2 chord = b - a, left(-chord.y(), chord.x());
      const Vec2 middle = 0.5 * (a + b) + (1.0 - bulge * bulge) / (4.0 * bulge) * left;
      const Vec2 u = a - middle;
      outline_.arc(middle, u, Vec2(-u.y(), u.x()), 0.0, 4.0 * std::atan(bulge), false);
    }
    if (is_closed) outline_.close();
  }

  // De Boor's algorithm at places that are dense enough for the largest second difference of the control points.
  void spline(const Entity& e) {
    const std::vector<double> x = values(e, 10), y = values(e, 20), z = values(e, 30), knots = values(e, 40);
    std::vector<double> weights = values(e, 41);
    const auto degree = static_cast<std::size_t>(value(e, 71));
    if (x.empty()) fail(e.line, "a SPLINE has fit points only; export it with its control points");
    if (degree < 1 || degree > 10 || x.size() != y.size() || x.size() <= degree ||
        knots.size() != x.size() + degree + 1 || !std::ranges::is_sorted(knots))
      fail(e.line, "a SPLINE is not whole");
    if (weights.size() != x.size()) weights.assign(x.size(), 1.0);
    if (!z.empty() && unit_mm_ * (std::ranges::max(z) - std::ranges::min(z)) > kJoined_mm) fail_tilted(e.line, e.kind);
    std::vector<Vec2> points;
    for (std::size_t k = 0; k < x.size(); ++k) points.push_back(unit_mm_ * Vec2(x[k], y[k]));
    const auto at = [&](std::size_t span, double t) -> Vec2 {
      std::vector<Vec2> p;
      std::vector<double> w;
      for (std::size_t j = 0; j <= degree; ++j) {
        w.push_back(weights[span - degree + j]);
        p.push_back(w.back() * points[span - degree + j]);
      }
      for (std::size_t r = 1; r <= degree; ++r) {
        for (std::size_t j = degree; j >= r; --j) {
          const double low = knots[span - degree + j], width = knots[span + 1 + j - r] - low;
          const double s = width > 0.0 ? (t - low) / width : 0.0;
          p[j] = (1.0 - s) * p[j - 1] + s * p[j];
          w[j] = (1.0 - s) * w[j - 1] + s * w[j];
        }
      }
      return p[degree] / w[degree];
    };
    bool begins = true;
    for (std::size_t span = degree; span < x.size(); ++span) {
      if (!(knots[span + 1] > knots[span])) continue;
      if (begins) outline_.move_to(at(span, knots[span]));
      begins = false;
      flatten([&](double t) { return at(span, t); }, knots[span], knots[span + 1], 0);
    }
    if ((static_cast<int>(value(e, 70, 0.0)) & 1) != 0) outline_.close();
  }
  // Halves a piece until its quarter points lie within a quarter of the tolerance of its chord: a rational curve has no
  // simple bound of its bend. Between knots the curve is smooth, so that four places show it.
  template <class Place>
  void flatten(const Place& place, double from, double to, int depth) {
    constexpr int kMinDepth = 2, kMaxDepth = 14;
    const Vec2 a = place(from), b = place(to);
    double off_mm = 0.0;
    for (const double t : {0.25, 0.5, 0.75}) {
      const Vec2 p = place(from + t * (to - from)), chord = b - a;
      const double length = chord.norm();
      const Vec2 d = p - a;
      off_mm = std::max(off_mm, length > 0.0 ? std::abs(chord.x() * d.y() - chord.y() * d.x()) / length : d.norm());
    }
    if (depth >= kMinDepth && (off_mm <= 0.25 * kFlattening_mm || depth >= kMaxDepth)) return outline_.line_to(b);
    const double middle = 0.5 * (from + to);
    flatten(place, from, middle, depth + 1);
    flatten(place, middle, to, depth + 1);
  }

  struct OpenPolyline {
    std::vector<Corner> corners;
    bool is_closed = false, is_shown = true;
    double z = 0.0;  // of its first corner, in the drawing's unit
  };
  const std::string& name_;
  Outline outline_;
  std::vector<Group> groups_;
  std::set<std::string> off_layers_{"DEFPOINTS"};  // Points of dimensions lie on it; it is never plotted.
  std::set<std::string> unread_;
  std::optional<OpenPolyline> polyline_;
  std::optional<double> given_mm_;
  double unit_mm_, flip_ = 1.0;
  bool says_unit_ = false, has_curves_ = false, had_curves_ = false;
};

}  // namespace

Drawing outline_of_dxf(const std::string& text, const std::string& name, std::optional<double> unit_mm) {
  return DxfReader(text, name, unit_mm).read();
}

}  // namespace triskin::placement
