// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/check/flat_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <tuple>
#include <vector>

#include "checked_design.hpp"
#include "flat_edges.hpp"
#include "triskin/base/error.hpp"

namespace triskin::check {
namespace {

using nlohmann::json;

constexpr double kInner_mm = kSide * kRoot3 / 6.0, kOuter_mm = 2.0 * kInner_mm;

struct FlatModule {
  P2 middle;
  std::vector<P2> body;  // Drawn in by the tolerance on every side.
};

struct Layout {
  P2 origin;                    // The first point of the outline is subtracted: it may lie 100 km away.
  std::vector<FlatEdge> edges;  // Of all rings.
  double area_mm2 = 0.0;
  double gap_mm = 0.0, tolerance_mm = 0.0;
  int stated_modules = 0, stated_bound = 0;
  std::size_t lattices = 0;
  std::vector<FlatModule> modules;
};

// Adds a ring with the inside of the outline on its left.
void read_ring(const json& points, bool is_outer, Layout& layout) {
  std::vector<P2> ring;
  for (const json& p : points) ring.emplace_back(p.at(0).get<double>(), p.at(1).get<double>());
  if (ring.size() < 3) throw InputError("a ring has fewer than three points");
  if (is_outer) layout.origin = ring[0];
  double twice = 0.0;
  for (P2& p : ring) p -= layout.origin;
  for (std::size_t k = 1; k + 1 < ring.size(); ++k) {
    const P2 u = ring[k] - ring[0], v = ring[k + 1] - ring[0];
    twice += u.x() * v.y() - u.y() * v.x();
  }
  layout.area_mm2 += (is_outer ? 0.5 : -0.5) * std::abs(twice);
  if ((twice > 0.0) != is_outer) std::ranges::reverse(ring);
  add_ring(ring, layout.edges);
}

double distance(const P2& p, const FlatEdge& e) {
  const P2 d = e.b - e.a;
  const double length2 = d.squaredNorm();
  if (!(length2 > 0.0)) return (p - e.a).norm();
  return (p - e.a - std::clamp((p - e.a).dot(d) / length2, 0.0, 1.0) * d).norm();
}

// Edges may touch: a crack of the net is a cut. By rounding they then cross by far less than this.
void require_simple(const Layout& layout) {
  constexpr double kMeet_mm = 1e-6;
  for (std::size_t a = 0; a < layout.edges.size(); ++a) {
    for (std::size_t b = a + 1; b < layout.edges.size(); ++b) {
      const FlatEdge &one = layout.edges[a], &other = layout.edges[b];
      if (!do_cross(one, other) || std::min({distance(one.a, other), distance(one.b, other), distance(other.a, one),
                                             distance(other.b, one)}) <= kMeet_mm)
        continue;
      const P2 p = one.a + layout.origin;
      throw InputError(fmt::format("the outline crosses itself near ({:g}, {:g})", p.x(), p.y()));
    }
  }
}

// The grid as docs/design_file.md writes it down, with triangles of 30 mm in the middle of cells that are wider by half
// the gap on every side.
FlatModule module_of(const json& tile, const json& lattice, const Layout& layout) {
  const double pitch = kSide + layout.gap_mm * kRoot3, theta = lattice.at("theta_rad").get<double>();
  const bool up = tile.at("up").get<bool>();
  const double third = up ? 1.0 / 3.0 : 2.0 / 3.0;
  const double u = tile.at("i").get<double>() + third, v = tile.at("j").get<double>() + third;
  const double x = pitch * (u + 0.5 * v) - lattice.at("x_mm").get<double>(),
               y = pitch * kRoot3 / 2.0 * v - lattice.at("y_mm").get<double>();
  const double c = std::cos(theta), s = std::sin(theta);
  FlatModule module{P2(c * x + s * y, c * y - s * x) - layout.origin, {}};
  const double radius = kOuter_mm * (1.0 - layout.tolerance_mm / kInner_mm);
  for (int k = 0; k < 3; ++k) {
    const double angle = ((up ? -5.0 : -3.0) + 4.0 * k) * std::numbers::pi / 6.0 - theta;
    module.body.emplace_back(module.middle + radius * P2(std::cos(angle), std::sin(angle)));
  }
  return module;
}

Layout read_layout(const json& file, Findings& f) {
  Layout layout;
  read_ring(file.at("outer"), true, layout);
  for (const json& hole : file.at("holes")) read_ring(hole, false, layout);
  require_simple(layout);
  layout.gap_mm = file.at("gap_mm").get<double>();
  layout.tolerance_mm = file.at("tolerance_mm").get<double>();
  if (!(layout.gap_mm >= 0.0 && layout.gap_mm <= 100.0) || !(layout.tolerance_mm > 0.0 && layout.tolerance_mm <= 1.0))
    throw InputError("gap_mm must be 0 … 100 and tolerance_mm at most 1");
  layout.stated_modules = file.at("modules").get<int>();
  layout.stated_bound = file.at("upper_bound").get<int>();
  f.rule("tile-unique");
  for (const json& lattice : file.at("lattices")) {
    std::set<std::tuple<int, int, bool>> tiles;
    for (const json& tile : lattice.at("tiles")) {
      if (!tiles.emplace(tile.at("i").get<int>(), tile.at("j").get<int>(), tile.at("up").get<bool>()).second)
        f.broken("tile-unique", "module " + std::to_string(layout.modules.size()), "its tile is listed twice");
      layout.modules.push_back(module_of(tile, lattice, layout));
    }
    ++layout.lattices;
  }
  return layout;
}

void check_inside(const Layout& layout, Findings& f) {
  f.rule("flat-inside");
  for (std::size_t k = 0; k < layout.modules.size(); ++k) {
    const FlatModule& m = layout.modules[k];
    if (!is_inside(m.middle, layout.edges) ||
        !std::ranges::all_of(layout.edges, [&](const FlatEdge& e) { return is_free_of(m.body, e); }))
      f.broken("flat-inside", "module " + std::to_string(k), "does not lie inside the outline");
  }
}

// Of two triangles that do not overlap.
double distance(const std::vector<P2>& one, const std::vector<P2>& other) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t s = 0; s < 3; ++s) {
      least = std::min(
          {least, distance(one[k], {other[s], other[(s + 1) % 3]}), distance(other[k], {one[s], one[(s + 1) % 3]})});
    }
  }
  return least;
}

// Both bodies are drawn in by the tolerance, so a gap that is kept within it is kept by them.
void check_gaps(const Layout& layout, Findings& f) {
  f.rule("flat-gap");
  const double reach = 2.0 * kOuter_mm + layout.gap_mm;
  for (std::size_t a = 0; a < layout.modules.size(); ++a) {
    for (std::size_t b = a + 1; b < layout.modules.size(); ++b) {
      const FlatModule &one = layout.modules[a], &other = layout.modules[b];
      if ((one.middle - other.middle).squaredNorm() > reach * reach) continue;
      if (!are_apart(one.body, other.body))
        f.broken("flat-gap", "module " + std::to_string(a), fmt::format("overlaps module {}", b));
      else if (const double mm = distance(one.body, other.body); mm < layout.gap_mm)
        f.broken("flat-gap", "module " + std::to_string(a),
                 fmt::format("is {:.4f} mm from module {}; the gap is {:g} mm", mm, b, layout.gap_mm));
    }
  }
}

// Proves a bound: squares of which no point can lie in a module are taken off, and what is left counts by parts that
// hang together.
class Bound {
 public:
  Bound(const Layout& layout, int across) : layout_(layout) {
    Eigen::AlignedBox2d box;
    for (const FlatEdge& e : layout.edges) box.extend(e.a);
    low_ = box.min();
    size_ = std::max(box.sizes().maxCoeff(), 1.0) / across;
    columns_ = static_cast<int>(std::ceil(box.sizes().x() / size_)) + 1;
    rows_ = static_cast<int>(std::ceil(box.sizes().y() / size_)) + 1;
  }

  int modules() {
    std::vector<char> used = squares_of_modules(rows_to_a_middle());
    const double module = kModule_mm2 * std::pow(1.0 - layout_.tolerance_mm / kInner_mm, 2.0);
    int sum = 0;
    for (const double area : parts(used)) sum += static_cast<int>(std::floor(area / module * (1.0 + 1e-9)));
    return sum;
  }

 private:
  [[nodiscard]] double half_diagonal() const { return size_ * std::sqrt(0.5); }
  [[nodiscard]] std::size_t index(int c, int r) const {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c);
  }

  // Returns for each square how many rows above or below is the nearest square in which a module's middle can lie: its
  // incircle needs room.
  [[nodiscard]] std::vector<int> rows_to_a_middle() const {
    constexpr int kFar = 1'000'000;
    std::vector<int> away(index(0, rows_), kFar);
    for (int c = 0; c < columns_; ++c) {
      for (int r = 0; r < rows_; ++r) {
        const P2 p = low_ + size_ * P2(c + 0.5, r + 0.5);
        double depth = std::numeric_limits<double>::infinity();
        for (const FlatEdge& e : layout_.edges) depth = std::min(depth, distance(p, e));
        if (!is_inside(p, layout_.edges)) depth = -depth;
        if (depth + half_diagonal() >= kInner_mm - layout_.tolerance_mm)
          away[index(c, r)] = 0;
        else if (r > 0)
          away[index(c, r)] = away[index(c, r - 1)] + 1;
      }
      for (int r = rows_ - 2; r >= 0; --r) away[index(c, r)] = std::min(away[index(c, r)], away[index(c, r + 1)] + 1);
    }
    return away;
  }

  // Marks squares that have a point within the circumradius of a point of those.
  [[nodiscard]] std::vector<char> squares_of_modules(const std::vector<int>& away) const {
    const double reach = (kOuter_mm + 2.0 * half_diagonal()) / size_;
    const int across = static_cast<int>(reach);
    std::vector<char> used(away.size(), 0);
    for (int r = 0; r < rows_; ++r) {
      for (int c = 0; c < columns_; ++c) {
        for (int x = std::max(0, c - across); x <= std::min(columns_ - 1, c + across) && used[index(c, r)] == 0; ++x)
          used[index(c, r)] = std::hypot(x - c, away[index(x, r)]) <= reach ? 1 : 0;
      }
    }
    return used;
  }

  // Area of the outline in a square: the integral of its height over x, edge by edge.
  [[nodiscard]] double area_in(int c, int r) const {
    const P2 low = low_ + size_ * P2(c, r);
    double sum = 0.0;
    for (const FlatEdge& e : layout_.edges)
      sum -= area_under(e.a, e.b, low.x(), low.x() + size_, low.y(), low.y() + size_);
    return std::max(0.0, sum);
  }

  // ∫ (clamp(y, low, high) − low) dx along a segment, within left … right.
  static double area_under(const P2& a, const P2& b, double left, double right, double low, double high) {
    const double dx = b.x() - a.x();
    if (dx == 0.0) return 0.0;
    const double from = std::clamp((left - a.x()) / dx, 0.0, 1.0), to = std::clamp((right - a.x()) / dx, 0.0, 1.0);
    const double dy = b.y() - a.y(), begin = std::min(from, to), end = std::max(from, to);
    std::array<double, 4> cut{begin, end, dy == 0.0 ? begin : std::clamp((low - a.y()) / dy, begin, end),
                              dy == 0.0 ? begin : std::clamp((high - a.y()) / dy, begin, end)};
    std::ranges::sort(cut);
    double sum = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto height = [&](double t) { return std::clamp(a.y() + t * dy, low, high) - low; };
      sum += (cut[k + 1] - cut[k]) * dx * 0.5 * (height(cut[k]) + height(cut[k + 1]));
    }
    return sum;
  }

  std::vector<double> parts(std::vector<char>& used) const {
    std::vector<double> areas;
    std::vector<std::pair<int, int>> open;
    const double nothing = 1e-9 * size_ * size_;
    for (int r = 0; r < rows_; ++r) {
      for (int c = 0; c < columns_; ++c) {
        if (used[index(c, r)] == 0) continue;
        double area = 0.0;
        open.emplace_back(c, r);
        while (!open.empty()) {
          const auto [x, y] = open.back();
          open.pop_back();
          if (x < 0 || y < 0 || x >= columns_ || y >= rows_ || used[index(x, y)] == 0) continue;
          used[index(x, y)] = 0;
          const double here = area_in(x, y);
          if (here <= nothing) continue;
          area += here;
          for (int dy = -1; dy <= 1; ++dy) {
            for (int dx = -1; dx <= 1; ++dx) open.emplace_back(x + dx, y + dy);
          }
        }
        if (area > 0.0) areas.push_back(area);
      }
    }
    return areas;
  }

  const Layout& layout_;
  P2 low_;
  double size_;
  int columns_, rows_;
};

// Areas of modules and outline widened by half the gap.
int bound_by_gap(const Layout& layout) {
  const double half = layout.gap_mm / 2.0, scale = 1.0 - layout.tolerance_mm / kInner_mm,
               disc = std::numbers::pi * half * half;
  double border = 0.0;
  for (const FlatEdge& e : layout.edges) border += (e.b - e.a).norm();
  const double module = kModule_mm2 * scale * scale + 3.0 * kSide * scale * half + disc;
  return static_cast<int>(std::floor((layout.area_mm2 + border * half + disc) / module * (1.0 + 1e-9)));
}

}  // namespace

bool is_flat_layout(const std::string& text) {
  return text.substr(0, 200).find("triskin-flat-layout") != std::string::npos;
}

FlatLayoutReport check_flat_layout(const std::string& text, const std::string& name) {
  FlatLayoutReport result;
  Findings findings(result.report);
  Layout layout;
  try {
    layout = read_layout(json::parse(text), findings);
  } catch (const json::exception& e) {
    throw InputError(fmt::format("{}: not a layout of `triskin place --lattices` ({})", name, e.what()));
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", name, e.what()));
  }
  check_inside(layout, findings);
  check_gaps(layout, findings);
  findings.rule("flat-number");
  const int modules = static_cast<int>(layout.modules.size());
  if (layout.stated_modules != modules)
    findings.broken("flat-number", "layout", fmt::format("states {} modules, has {}", layout.stated_modules, modules));
  findings.rule("flat-bound");
  result.own_upper_bound = layout.gap_mm > 0.0 ? bound_by_gap(layout) : std::numeric_limits<int>::max();
  // Where a neck is no wider than some squares, it takes smaller ones to prove what is stated.
  for (const int across : {400, 800}) {
    if (result.own_upper_bound <= layout.stated_bound) break;
    result.own_upper_bound = std::min(result.own_upper_bound, Bound(layout, across).modules());
  }
  if (layout.stated_bound < std::max(modules, result.own_upper_bound))
    findings.broken("flat-bound", "layout",
                    fmt::format("states a bound of {}; {} is proved", layout.stated_bound, result.own_upper_bound));
  result.report.modules = layout.modules.size();
  result.lattices = layout.lattices;
  result.upper_bound = layout.stated_bound;
  result.gap_mm = layout.gap_mm;
  result.tolerance_mm = layout.tolerance_mm;
  return result;
}

}  // namespace triskin::check
