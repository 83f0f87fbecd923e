// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/fabrication/nesting.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>
#include <tuple>

#include "triskin/base/error.hpp"

namespace triskin::fabrication {
namespace {

using design::Vec2;

constexpr double kPixel_mm = 0.5;
// Islands consist of triangles: turned by 60° they fit each other, turned by 30° the edges of the sheet.
constexpr int kTurns = 12;
constexpr std::size_t kWord = 64;

double area_within(const std::vector<Vec2>& ring) {
  double twice = 0.0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

double area_of(const FlatIsland& island) {
  double area = area_within(island.outline_mm);
  for (const auto& hole : island.holes_mm) area += area_within(hole);  // Holes run clockwise.
  return area;
}

Vec2 rotated(const Vec2& p, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {c * p.x() - s * p.y(), s * p.x() + c * p.y()};
}

double distance_to_side(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double t = std::clamp((p - a).dot(d) / std::max(d.squaredNorm(), 1e-12), 0.0, 1.0);
  return (p - a - t * d).norm();
}

// The run covers the pixels first … end − 1 of a row.
struct Run {
  int first, end;
};

// A silhouette stores, for one orientation of an island, the runs of pixels that the island and half the gap touch. The
// corner (0, 0) of the island is also the corner of the pixels.
class Silhouette {
 public:
  Silhouette(const std::vector<Vec2>& outline, int turn, double half_gap_mm)
      : angle_rad_(turn * 2.0 * std::numbers::pi / kTurns) {
    std::vector<Vec2> ring;
    Vec2 low(1e9, 1e9), high(-1e9, -1e9);
    for (const Vec2& p : outline) {
      ring.push_back(rotated(p, angle_rad_));
      low = low.cwiseMin(ring.back());
      high = high.cwiseMax(ring.back());
    }
    shift_mm_ = Vec2(half_gap_mm, half_gap_mm) - low;
    for (Vec2& p : ring) p += shift_mm_;
    width_ = static_cast<int>(std::ceil((high.x() - low.x() + 2.0 * half_gap_mm) / kPixel_mm));
    height_ = static_cast<int>(std::ceil((high.y() - low.y() + 2.0 * half_gap_mm) / kPixel_mm));
    draw(ring, half_gap_mm);
  }

  [[nodiscard]] double angle_rad() const { return angle_rad_; }
  [[nodiscard]] const Vec2& shift_mm() const { return shift_mm_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] const std::vector<std::vector<Run>>& rows() const { return rows_; }

 private:
  void draw(const std::vector<Vec2>& ring, double half_gap_mm) {
    std::vector<std::vector<char>> is_set(static_cast<std::size_t>(height_),
                                          std::vector<char>(static_cast<std::size_t>(width_), 0));
    fill_inside(ring, is_set);
    // A pixel counts as touched if its middle is within the gap plus half of the pixel's diagonal.
    const double reach = half_gap_mm + kPixel_mm * std::numbers::sqrt2 / 2.0;
    for (std::size_t k = 0; k < ring.size(); ++k) draw_side(ring[k], ring[(k + 1) % ring.size()], reach, is_set);
    for (const auto& row : is_set) {
      rows_.emplace_back();
      for (int x = 0; x < width_; ++x) {
        if (!row[static_cast<std::size_t>(x)]) continue;
        if (rows_.back().empty() || rows_.back().back().end < x)
          rows_.back().push_back({x, x + 1});
        else
          rows_.back().back().end = x + 1;
      }
    }
  }

  // Fills each row between the sides of the outline that cross the middles of its pixels.
  void fill_inside(const std::vector<Vec2>& ring, std::vector<std::vector<char>>& is_set) const {
    for (int y = 0; y < height_; ++y) {
      const double level = (y + 0.5) * kPixel_mm;
      std::vector<double> crossed;
      for (std::size_t k = 0; k < ring.size(); ++k) {
        const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
        if ((a.y() > level) != (b.y() > level))
          crossed.push_back(a.x() + (level - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
      }
      std::ranges::sort(crossed);
      for (std::size_t k = 0; k + 1 < crossed.size(); k += 2) {
        const int from = std::max(0, static_cast<int>(std::floor(crossed[k] / kPixel_mm)));
        const int to = std::min(width_, static_cast<int>(std::ceil(crossed[k + 1] / kPixel_mm)));
        for (int x = from; x < to; ++x) is_set[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] = 1;
      }
    }
  }

  void draw_side(const Vec2& a, const Vec2& b, double reach, std::vector<std::vector<char>>& is_set) const {
    const Vec2 low = a.cwiseMin(b), high = a.cwiseMax(b);
    const auto pixel = [](double mm, int count) {
      return std::clamp(static_cast<int>(std::floor(mm / kPixel_mm)), 0, count - 1);
    };
    for (int y = pixel(low.y() - reach, height_); y <= pixel(high.y() + reach, height_); ++y) {
      for (int x = pixel(low.x() - reach, width_); x <= pixel(high.x() + reach, width_); ++x) {
        if (distance_to_side(Vec2((x + 0.5) * kPixel_mm, (y + 0.5) * kPixel_mm), a, b) <= reach)
          is_set[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] = 1;
      }
    }
  }

  double angle_rad_;
  Vec2 shift_mm_{0, 0};
  int width_ = 0, height_ = 0;
  std::vector<std::vector<Run>> rows_;
};

using Bits = std::vector<std::uint64_t>;

// Computes bits |= more >> shift, where `shift` counts pixels.
void add_shifted(Bits& bits, const Bits& more, int shift) {
  const std::size_t words = static_cast<std::size_t>(shift) / kWord, rest = static_cast<std::size_t>(shift) % kWord;
  for (std::size_t k = 0; k + words < more.size(); ++k) {
    std::uint64_t word = more[k + words] >> rest;
    if (rest > 0 && k + words + 1 < more.size()) word |= more[k + words + 1] << (kWord - rest);
    bits[k] |= word;
  }
}

// The sheet stores its taken pixels and, for each row and power of two, the starts where a run of that length collides.
class Sheet {
 public:
  Sheet(int width, int height)
      : width_(width),
        height_(height),
        levels_(static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(width)))),
        rows_(static_cast<std::size_t>(height),
              std::vector<Bits>(levels_, Bits((static_cast<std::size_t>(width) + kWord - 1) / kWord, 0))) {}

  struct Place {
    int x, y;
  };
  // Returns the lowest place that ends below `top`; among equally low places, the leftmost.
  [[nodiscard]] std::optional<Place> lowest(const Silhouette& s, int top) const {
    for (int y = 0; y + s.height() <= std::min(top, height_); ++y) {
      if (const int x = leftmost(s, y); x >= 0) return Place{x, y};
    }
    return std::nullopt;
  }

  void take(const Silhouette& s, const Place& at) {
    for (int r = 0; r < s.height(); ++r) {
      std::vector<Bits>& row = rows_[static_cast<std::size_t>(at.y + r)];
      for (const Run& run : s.rows()[static_cast<std::size_t>(r)]) {
        for (int x = at.x + run.first; x < at.x + run.end; ++x)
          row[0][static_cast<std::size_t>(x) / kWord] |= std::uint64_t{1} << (static_cast<std::size_t>(x) % kWord);
      }
      for (std::size_t level = 1; level < levels_; ++level) {
        row[level] = row[level - 1];
        add_shifted(row[level], row[level - 1], 1 << (level - 1));
      }
    }
  }

 private:
  // Visits the numbers 0 … count − 1 in the order 0, 16, 32, …, 1, 17, …
  [[nodiscard]] static int spread(int k, int count) {
    constexpr int kStride = 16;
    const int full = count / kStride, rest = count % kStride;  // The first `rest` passes have one more.
    const int in_longer = rest * (full + 1);
    if (k < in_longer) return k % (full + 1) * kStride + k / (full + 1);
    return (k - in_longer) % full * kStride + rest + (k - in_longer) / full;
  }

  // Returns −1 if the silhouette fits nowhere in the row.
  [[nodiscard]] int leftmost(const Silhouette& s, int y) const {
    const int places = width_ - s.width() + 1;
    if (places <= 0) return -1;
    Bits blocked(rows_[0][0].size(), ~std::uint64_t{0});
    for (int x = 0; x < places; ++x)
      blocked[static_cast<std::size_t>(x) / kWord] &= ~(std::uint64_t{1} << (static_cast<std::size_t>(x) % kWord));
    // Rows far from each other come first, because together they exclude most places early.
    for (int k = 0; k < s.height(); ++k) {
      if (std::ranges::all_of(blocked, [](std::uint64_t word) { return word == ~std::uint64_t{0}; })) return -1;
      const int r = spread(k, s.height());
      const std::vector<Bits>& row = rows_[static_cast<std::size_t>(y + r)];
      for (const Run& run : s.rows()[static_cast<std::size_t>(r)]) {
        const std::size_t level =
            static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(run.end - run.first))) - 1;
        add_shifted(blocked, row[level], run.first);
        add_shifted(blocked, row[level], run.end - (1 << level));
      }
    }
    for (int x = 0; x < places; ++x) {
      if (((blocked[static_cast<std::size_t>(x) / kWord] >> (static_cast<std::size_t>(x) % kWord)) & 1U) == 0) return x;
    }
    return -1;
  }

  int width_, height_;
  std::size_t levels_;
  std::vector<std::vector<Bits>> rows_;
};

// Outcomes are compared by the number of sheets, then by the rows used on the last one.
struct Outcome {
  std::vector<NestedIsland> places;
  std::vector<int> used_rows;
  [[nodiscard]] std::tuple<std::size_t, int> cost() const { return {used_rows.size(), used_rows.back()}; }
};

class Nester {
 public:
  Nester(const std::vector<FlatIsland>& islands, const SheetOptions& options)
      : options_(options),
        // The silhouettes include half the gap at the edges; the sheet is reduced by the other half.
        width_(static_cast<int>(std::floor((options.width_mm - options.gap_mm) / kPixel_mm))),
        height_(static_cast<int>(std::floor((options.length_mm - options.gap_mm) / kPixel_mm))) {
    for (const FlatIsland& island : islands) {
      silhouettes_.emplace_back();
      for (int turn = 0; turn < kTurns; ++turn)
        silhouettes_.back().emplace_back(island.outline_mm, turn, options.gap_mm / 2.0);
      require_fit(island, silhouettes_.back());
    }
  }

  [[nodiscard]] Outcome best(std::vector<std::size_t> order) const {
    std::mt19937_64 dice(options_.seed);
    Outcome best = outcome_of(order);
    for (int k = 1; k < options_.tries && order.size() > 1; ++k) {
      std::vector<std::size_t> other = order;
      // The library's distributions give numbers that depend on the compiler, so we take the remainder.
      std::swap(other[dice() % other.size()], other[dice() % other.size()]);
      Outcome outcome = outcome_of(other);
      if (outcome.cost() > best.cost()) continue;
      best = std::move(outcome);
      order = std::move(other);
    }
    return best;
  }

 private:
  void require_fit(const FlatIsland& island, const std::vector<Silhouette>& turns) const {
    const bool fits =
        std::ranges::any_of(turns, [&](const Silhouette& s) { return s.width() <= width_ && s.height() <= height_; });
    if (fits) return;
    throw InputError(fmt::format("{} of {:.0f} × {:.0f} mm fits no sheet of {:g} × {:g} mm; give a larger --sheet-mm",
                                 island.part_number, turns[0].width() * kPixel_mm - options_.gap_mm,
                                 turns[0].height() * kPixel_mm - options_.gap_mm, options_.width_mm,
                                 options_.length_mm));
  }

  [[nodiscard]] Outcome outcome_of(const std::vector<std::size_t>& order) const {
    Outcome outcome;
    outcome.places.resize(order.size());
    std::vector<Sheet> sheets;
    for (const std::size_t island : order) {
      std::size_t sheet = 0;
      while (sheet < sheets.size() && !place(island, sheet, sheets[sheet], outcome)) ++sheet;
      if (sheet < sheets.size()) continue;
      sheets.emplace_back(width_, height_);
      outcome.used_rows.push_back(0);
      place(island, sheet, sheets.back(), outcome);
    }
    return outcome;
  }

  // Places the island in the orientation that ends lowest.
  bool place(std::size_t island, std::size_t number, Sheet& sheet, Outcome& outcome) const {
    const Silhouette* best = nullptr;
    Sheet::Place at{0, 0};
    int top = std::numeric_limits<int>::max();
    for (const Silhouette& s : silhouettes_[island]) {
      const auto found = sheet.lowest(s, top - 1);
      if (!found) continue;
      best = &s;
      at = *found;
      top = at.y + s.height();
    }
    if (best == nullptr) return false;
    sheet.take(*best, at);
    outcome.used_rows[number] = std::max(outcome.used_rows[number], top);
    const double edge_mm = options_.gap_mm / 2.0;
    outcome.places[island] = {island, static_cast<int>(number), best->angle_rad(),
                              best->shift_mm() + Vec2(at.x * kPixel_mm + edge_mm, at.y * kPixel_mm + edge_mm)};
    return true;
  }

  const SheetOptions& options_;
  int width_, height_;
  std::vector<std::vector<Silhouette>> silhouettes_;  // The indices are the island, then the turn.
};

void require_options(const SheetOptions& o) {
  const auto require = [](double value, double low, double high, const char* what) {
    if (!(value >= low && value <= high))
      throw InputError(fmt::format("{} of {:g} is out of range: {:g} … {:g}", what, value, low, high));
  };
  require(o.width_mm, 50.0, 2000.0, "a sheet's width in mm");
  require(o.length_mm, 50.0, 2000.0, "a sheet's length in mm");
  require(o.gap_mm, 0.0, 20.0, "a gap in mm");
  require(o.tries, 1, 1000, "a number of orders");
}

}  // namespace

Nesting nest(const std::vector<FlatIsland>& islands, const SheetOptions& options) {
  require_options(options);
  if (islands.empty()) return {};
  std::vector<std::size_t> order(islands.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t k) { return area_of(islands[k]); });
  Outcome outcome = Nester(islands, options).best(std::move(order));
  Nesting nesting;
  nesting.places = std::move(outcome.places);
  for (const int rows : outcome.used_rows) {
    nesting.used_mm.push_back(std::min(options.length_mm, rows * kPixel_mm + options.gap_mm));
    nesting.fill.push_back(0.0);
  }
  for (const NestedIsland& p : nesting.places) {
    const auto sheet = static_cast<std::size_t>(p.sheet);
    nesting.fill[sheet] += area_of(islands[p.island]) / (options.width_mm * nesting.used_mm[sheet]);
  }
  return nesting;
}

FlatIsland on_sheet(FlatIsland island, const NestedIsland& place) {
  const auto move = [&place](Vec2& p) { p = rotated(p, place.angle_rad) + place.shift_mm; };
  for (Vec2& p : island.outline_mm) move(p);
  for (auto& hole : island.holes_mm) std::ranges::for_each(hole, move);
  for (Fold& fold : island.folds) {
    move(fold.from_mm);
    move(fold.to_mm);
  }
  for (Slit& slit : island.slits) {
    move(slit.from_mm);
    move(slit.to_mm);
  }
  for (Mark& mark : island.marks) {
    move(mark.at_mm);
    mark.angle_rad += place.angle_rad;
  }
  return island;
}

std::string places_csv(const std::vector<FlatIsland>& islands, const Nesting& nesting) {
  std::string text = "part_number,sheet,x_mm,y_mm,angle_deg\r\n";
  for (const NestedIsland& p : nesting.places)
    text += fmt::format("{},{},{:.3f},{:.3f},{:.0f}\r\n", islands[p.island].part_number, p.sheet + 1, p.shift_mm.x(),
                        p.shift_mm.y(), p.angle_rad * 180.0 / std::numbers::pi);
  return text;
}

}  // namespace triskin::fabrication
