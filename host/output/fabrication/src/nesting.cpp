// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/fabrication/nesting.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <numbers>
#include <numeric>
#include <utility>

#include "bottom_left.hpp"
#include "compaction.hpp"
#include "overlap_search.hpp"
#include "silhouette.hpp"
#include "triskin/base/error.hpp"

namespace triskin::fabrication {
namespace {

using design::Vec2;

// A try is this much work for each island, about 10 ms; more islands than these share it.
constexpr std::int64_t kTryWork = 16'000'000;
constexpr std::size_t kMaxWorkIslands = 14;
// No point of a pixel is farther from its middle than this.
const double kHalfDiagonal_mm = kPixel_mm * std::numbers::sqrt2 / 2.0;

double area_of(const FlatIsland& island) {
  double area = area_within(island.outline_mm);
  for (const auto& hole : island.holes_mm) area += area_within(hole);  // Holes run clockwise.
  return area;
}

// Returns the outline of each island and those of its holes in which the smallest island could lie.
std::vector<std::vector<Ring>> rings_of(const std::vector<FlatIsland>& islands) {
  double smallest = area_within(islands.front().outline_mm);
  for (const FlatIsland& island : islands) smallest = std::min(smallest, area_within(island.outline_mm));
  std::vector<std::vector<Ring>> rings;
  for (const FlatIsland& island : islands) {
    rings.push_back({island.outline_mm});
    for (const Ring& hole : island.holes_mm) {
      if (-area_within(hole) > smallest) rings.back().push_back(hole);
    }
  }
  return rings;
}

class Nester {
 public:
  Nester(const std::vector<FlatIsland>& islands, const SheetOptions& options)
      : islands_(islands),
        options_(options),
        rings_(rings_of(islands)),
        // The silhouettes include half the gap at the edges; the sheet is reduced by the other half.
        width_(static_cast<int>(std::floor((options.width_mm - options.gap_mm) / kPixel_mm))),
        height_(static_cast<int>(std::floor((options.length_mm - options.gap_mm) / kPixel_mm))),
        // Pixels that cover all of an island and half the gap guarantee the gap.
        start_(first_layout(silhouettes(options.gap_mm / 2.0 + kHalfDiagonal_mm))),
        // The search counts a pixel by its middle, which loses no room. A gap can become too small by a pixel's
        // diagonal then, so we cover as much more as is needed to keep the islands from overlapping; the compaction
        // restores the gap.
        exact_(silhouettes(std::max(options.gap_mm / 2.0, kHalfDiagonal_mm))) {}

  // Returns the layout that the search with this seed finds. Thread-safe.
  [[nodiscard]] std::vector<NestedIsland> places(std::uint64_t seed) const {
    OverlapSearch search(exact_, width_, height_, seed);
    const std::int64_t work =
        (options_.tries - 1) * kTryWork * static_cast<std::int64_t>(std::min(kMaxWorkIslands, islands_.size()));
    const std::vector<PixelPlace> found = search.shorten(start_, work);
    if (const auto shifts = compacted(bodies(found), room())) return nested(found, *shifts);
    if (const auto shifts = compacted(bodies(start_), room())) return nested(start_, *shifts);
    std::vector<Vec2> shifts;
    for (const Body& body : bodies(start_)) shifts.push_back(body.shift_mm);
    return nested(start_, shifts);
  }

 private:
  [[nodiscard]] CompactionRoom room() const { return {options_.width_mm, options_.length_mm, options_.gap_mm}; }

  [[nodiscard]] Silhouettes silhouettes(double reach_mm) const {
    Silhouettes all;
    for (const auto& rings : rings_) {
      all.emplace_back();
      for (int turn = 0; turn < kTurns; ++turn) all.back().emplace_back(rings, turn, options_.gap_mm / 2.0, reach_mm);
      require_fit(islands_[all.size() - 1], all.back());
    }
    return all;
  }

  void require_fit(const FlatIsland& island, const std::vector<Silhouette>& turns) const {
    const bool fits =
        std::ranges::any_of(turns, [&](const Silhouette& s) { return s.width() <= width_ && s.height() <= height_; });
    if (fits) return;
    throw InputError(fmt::format("{} of {:.0f} × {:.0f} mm fits no sheet of {:g} × {:g} mm; give a larger --sheet-mm",
                                 island.part_number, turns[0].width() * kPixel_mm - options_.gap_mm,
                                 turns[0].height() * kPixel_mm - options_.gap_mm, options_.width_mm,
                                 options_.length_mm));
  }

  [[nodiscard]] std::vector<PixelPlace> first_layout(const Silhouettes& covering) const {
    std::vector<std::size_t> order(islands_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater{}, [&](std::size_t k) { return area_of(islands_[k]); });
    return bottom_left(covering, order, width_, height_);
  }

  [[nodiscard]] std::vector<Body> bodies(const std::vector<PixelPlace>& places) const {
    std::vector<Body> bodies;
    for (std::size_t k = 0; k < places.size(); ++k) {
      const PixelPlace& p = places[k];
      Body& body = bodies.emplace_back(rings_[k], p.sheet);
      for (Ring& ring : body.rings_mm) {
        for (Vec2& point : ring) point = rotated(point, angle_of_turn(p.turn));
      }
      const double edge_mm = options_.gap_mm / 2.0;
      body.shift_mm = exact_[k][static_cast<std::size_t>(p.turn)].shift_mm() +
                      Vec2(p.x * kPixel_mm + edge_mm, p.y * kPixel_mm + edge_mm);
    }
    return bodies;
  }

  [[nodiscard]] static std::vector<NestedIsland> nested(const std::vector<PixelPlace>& places,
                                                        const std::vector<Vec2>& shifts) {
    std::vector<NestedIsland> islands;
    for (std::size_t k = 0; k < places.size(); ++k)
      islands.push_back({k, places[k].sheet, angle_of_turn(places[k].turn), shifts[k]});
    return islands;
  }

  const std::vector<FlatIsland>& islands_;
  const SheetOptions& options_;
  std::vector<std::vector<Ring>> rings_;
  int width_, height_;
  std::vector<PixelPlace> start_;
  Silhouettes exact_;
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

Nesting measured(const std::vector<FlatIsland>& islands, const SheetOptions& options,
                 std::vector<NestedIsland> places) {
  Nesting nesting;
  nesting.places = std::move(places);
  for (const NestedIsland& p : nesting.places) {
    const auto sheet = static_cast<std::size_t>(p.sheet);
    if (nesting.used_mm.size() <= sheet) nesting.used_mm.resize(sheet + 1, 0.0);
    for (const Vec2& point : islands[p.island].outline_mm) {
      const double end_mm = (rotated(point, p.angle_rad) + p.shift_mm).y() + options.gap_mm;
      nesting.used_mm[sheet] = std::max(nesting.used_mm[sheet], std::min(options.length_mm, end_mm));
    }
  }
  nesting.fill.assign(nesting.used_mm.size(), 0.0);
  for (const NestedIsland& p : nesting.places) {
    const auto sheet = static_cast<std::size_t>(p.sheet);
    nesting.fill[sheet] += area_of(islands[p.island]) / (options.width_mm * nesting.used_mm[sheet]);
  }
  return nesting;
}

}  // namespace

Nesting nest(const std::vector<FlatIsland>& islands, const SheetOptions& options) {
  require_options(options);
  if (islands.empty()) return {};
  const Nester nester(islands, options);
  // Searches with different seeds end up to two percent apart, and a second one costs no time where a core is idle.
  auto beside = std::async(std::launch::async, [&] { return nester.places(options.seed + 1); });
  Nesting one = measured(islands, options, nester.places(options.seed));
  Nesting other = measured(islands, options, beside.get());
  const auto length = [](const Nesting& n) { return std::pair(n.used_mm.size(), n.used_mm.back()); };
  return length(other) < length(one) ? other : one;
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
