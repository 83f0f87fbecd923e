// SPDX-License-Identifier: GPL-3.0-or-later
#include "overlap_search.hpp"

#include <algorithm>
#include <limits>

namespace triskin::fabrication {
namespace {

constexpr int kRefinedCandidates = 12;
// The best place of every 24 mm of a turn is a candidate, so that the candidates do not all lie in one corner.
constexpr int kBandRows = 8;
constexpr int kPassesWithoutGain = 20;
constexpr int kMaxFieldWeight = 1024;  // The sums of rows stay within 32 bits.

}  // namespace

OverlapSearch::OverlapSearch(const Silhouettes& silhouettes, int width, int height, std::uint64_t seed)
    : silhouettes_(silhouettes),
      width_(width),
      height_(height),
      dice_(seed),
      weights_(silhouettes.size() * silhouettes.size(), 1.0),
      overlaps_(silhouettes.size() * silhouettes.size(), 0) {
  for (const auto& turns : silhouettes) {
    coarse_.emplace_back();
    for (const Silhouette& s : turns) coarse_.back().push_back(s.coarser(OverlapField::kCoarse));
  }
}

std::vector<PixelPlace> OverlapSearch::shorten(const std::vector<PixelPlace>& start, std::int64_t work) {
  std::vector<PixelPlace> best = start;
  int best_length = length_of(best);
  const int shortest = shortest_length();
  work_left_ = work;
  places_ = best;
  bool has_failed = false;
  while (work_left_ > 0) {
    const int target = target_below(best_length, !has_failed);
    if (target < shortest) break;
    has_failed = !separate(target);
    if (has_failed) {
      places_ = best;
      exchange_two();
    } else {
      best = places_;
      best_length = length_of(best);
    }
  }
  return best;
}

const Silhouette& OverlapSearch::silhouette(std::size_t island, const PixelPlace& p) const {
  return silhouettes_[island][static_cast<std::size_t>(p.turn)];
}

int OverlapSearch::length_of(const std::vector<PixelPlace>& places) const {
  int length = 0;
  for (std::size_t k = 0; k < places.size(); ++k)
    length = std::max(length, places[k].sheet * height_ + places[k].y + silhouette(k, places[k]).height());
  return length;
}

// No layout is shorter than its tallest island, nor than all their areas together.
int OverlapSearch::shortest_length() const {
  int tallest = 0;
  std::int64_t area = 0;
  for (const auto& turns : silhouettes_) {
    int least_height = std::numeric_limits<int>::max();
    std::int64_t least_area = std::numeric_limits<std::int64_t>::max();
    for (const Silhouette& s : turns) {
      if (s.width() <= width_) least_height = std::min(least_height, s.height());
      std::int64_t pixels = 0;
      for (const auto& row : s.rows()) {
        for (const Run& run : row) pixels += run.end - run.first;
      }
      least_area = std::min(least_area, pixels);
    }
    tallest = std::max(tallest, least_height);
    area += least_area;
  }
  return std::max(tallest, static_cast<int>((area + width_ - 1) / width_));
}

// The next length to try; a last sheet too short for any island is given up.
int OverlapSearch::target_below(int length, bool in_large_steps) const {
  const int on_last = (length - 1) % height_ + 1;
  const int target = length - std::max(1, on_last / (in_large_steps ? 100 : 400));
  int lowest = std::numeric_limits<int>::max();
  for (const auto& turns : silhouettes_) {
    for (const Silhouette& s : turns) {
      if (s.width() <= width_) lowest = std::min(lowest, s.height());
    }
  }
  const int rest = target % height_;
  return rest < lowest ? target - rest : target;
}

int OverlapSearch::rows_of(int sheet) const {
  return std::min(height_, length_ - sheet * height_);
}

bool OverlapSearch::fits(std::size_t island, const PixelPlace& p) const {
  const Silhouette& s = silhouette(island, p);
  return s.width() <= width_ && s.height() <= rows_of(p.sheet);
}

bool OverlapSearch::separate(int length) {
  length_ = length;
  move_inside();
  std::ranges::fill(weights_, 1.0);
  for (std::size_t k = 0; k < places_.size(); ++k) measure(k);
  std::int64_t least = total_overlap();
  for (int without_gain = 0; least > 0 && without_gain < kPassesWithoutGain && work_left_ > 0; ++without_gain) {
    move_overlapping();
    raise_weights();
    const std::int64_t overlap = total_overlap();
    if (overlap < least - least / 50) without_gain = 0;
    least = std::min(least, overlap);
  }
  return least == 0;
}

// Islands that lie beyond the shortened room are pushed into it, turned or put on another sheet if need be.
void OverlapSearch::move_inside() {
  for (std::size_t k = 0; k < places_.size(); ++k) {
    PixelPlace& p = places_[k];
    for (int tried = 0; tried < sheet_count() && (p.sheet >= sheet_count() || !fits(k, p)); ++tried) {
      p.sheet = tried;
      for (int turn = 0; turn < kTurns && !fits(k, p); ++turn) p.turn = turn;
    }
    p.x = std::clamp(p.x, 0, width_ - silhouette(k, p).width());
    p.y = std::clamp(p.y, 0, rows_of(p.sheet) - silhouette(k, p).height());
  }
}

void OverlapSearch::move_overlapping() {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    if (overlap_of(k) > 0) order.push_back(k);
  }
  // The library's distributions give numbers that depend on the compiler, so we take the remainder.
  for (std::size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[dice_() % k]);
  for (const std::size_t island : order) {
    if (overlap_of(island) == 0) continue;  // An earlier move has freed it.
    places_[island] = best_place(island);
    measure(island);
  }
}

// Pairs that overlap more gain more weight; those that do not overlap forget it slowly.
void OverlapSearch::raise_weights() {
  const double largest = static_cast<double>(std::max<std::int64_t>(1, *std::ranges::max_element(overlaps_)));
  double heaviest = 1.0;
  for (std::size_t k = 0; k < weights_.size(); ++k) {
    if (overlaps_[k] > 0)
      weights_[k] *= 1.2 + 0.8 * static_cast<double>(overlaps_[k]) / largest;
    else
      weights_[k] = std::max(1.0, 0.95 * weights_[k]);
    heaviest = std::max(heaviest, weights_[k]);
  }
  if (heaviest < 1e6) return;
  for (double& weight : weights_) weight = std::max(1.0, 1e-3 * weight);
}

// Two islands change their middles, and now and then a third is turned; the next separation starts from there.
void OverlapSearch::exchange_two() {
  const std::size_t a = dice_() % places_.size(), b = dice_() % places_.size(), c = dice_() % places_.size();
  const auto move_to = [this](std::size_t island, PixelPlace to, const Silhouette& other) {
    PixelPlace& p = places_[island];
    p.sheet = to.sheet;
    p.x = to.x + (other.width() - silhouette(island, p).width()) / 2;
    p.y = to.y + (other.height() - silhouette(island, p).height()) / 2;
  };
  const PixelPlace at_a = places_[a], at_b = places_[b];
  move_to(a, at_b, silhouette(b, at_b));
  move_to(b, at_a, silhouette(a, at_a));
  if (dice_() % 4 == 0) places_[c].turn = static_cast<int>(dice_() % kTurns);
}

PixelPlace OverlapSearch::best_place(std::size_t island) {
  std::vector<Candidate> found;
  Candidate best{std::numeric_limits<std::int64_t>::max(), places_[island]};
  for (int sheet = 0; sheet < sheet_count() && best.overlap > 0; ++sheet) {
    fill_field(island, sheet);
    if (places_[island].sheet == sheet) {
      if (const Candidate here = refined(island, places_[island]); here.overlap < best.overlap) best = here;
    }
    for (const Candidate& candidate : candidates(island, sheet)) {
      if (best.overlap == 0) break;
      if (const Candidate near = refined(island, candidate.place); near.overlap < best.overlap) best = near;
    }
  }
  return best.place;
}

void OverlapSearch::fill_field(std::size_t island, int sheet) {
  field_.clear(width_, rows_of(sheet));
  double heaviest = 1.0;
  for (std::size_t k = 0; k < places_.size(); ++k) heaviest = std::max(heaviest, weights_[pair(island, k)]);
  for (std::size_t k = 0; k < places_.size(); ++k) {
    if (k == island || places_[k].sheet != sheet) continue;
    const int weight = std::max(1, static_cast<int>(weights_[pair(island, k)] / heaviest * kMaxFieldWeight));
    field_.add(silhouette(k, places_[k]), places_[k], weight);
  }
  field_.finish();
  work_left_ -= std::int64_t{2} * width_ * field_.height();
}

// Returns the most promising places of all turns, best first.
std::vector<OverlapSearch::Candidate> OverlapSearch::candidates(std::size_t island, int sheet) {
  std::vector<Candidate> found;
  for (int turn = 0; turn < kTurns; ++turn) {
    const PixelPlace turned{sheet, turn, 0, 0};
    if (fits(island, turned)) add_candidates(island, turned, found);
  }
  const std::size_t count = std::min<std::size_t>(kRefinedCandidates, found.size());
  std::ranges::stable_sort(found, {}, &Candidate::overlap);
  found.resize(count);
  return found;
}

void OverlapSearch::add_candidates(std::size_t island, const PixelPlace& turned, std::vector<Candidate>& found) {
  constexpr int kCoarse = OverlapField::kCoarse;
  const Silhouette& s = silhouette(island, turned);
  const Silhouette& coarse = coarse_[island][static_cast<std::size_t>(turned.turn)];
  const int last_x = width_ - s.width(), last_y = field_.height() - s.height();
  const int columns = (last_x + kCoarse - 1) / kCoarse + 1, rows = (last_y + kCoarse - 1) / kCoarse + 1;
  estimates_.resize(static_cast<std::size_t>(columns));
  for (int row = 0; row < rows; ++row) {
    field_.estimate(coarse, row, estimates_);
    const auto least = std::ranges::min_element(estimates_);
    const int column = static_cast<int>(least - estimates_.begin());
    if (row % kBandRows == 0) found.push_back({std::numeric_limits<std::int64_t>::max(), turned});
    const auto overlap = static_cast<std::int64_t>(*least);
    if (overlap >= found.back().overlap) continue;
    found.back().overlap = overlap;
    found.back().place.x = std::min(column * kCoarse, last_x);
    found.back().place.y = std::min(row * kCoarse, last_y);
  }
  work_left_ -= std::int64_t{1} * coarse.run_count() * columns * rows / 4;
}

// Goes down to the nearest minimum in steps of 4, 2 and 1 pixels. Large steps look at as many rows less.
OverlapSearch::Candidate OverlapSearch::refined(std::size_t island, const PixelPlace& from) {
  const Silhouette& s = silhouette(island, from);
  Candidate best{0, from};
  for (int step = 4; step > 0; step /= 2) {
    best.overlap = field_.overlap(s, best.place.x, best.place.y, step);
    for (bool moved = true; moved && best.overlap > 0;) {
      moved = false;
      const PixelPlace middle = best.place;
      for (int k = 0; k < 9; ++k) {
        PixelPlace p = middle;
        p.x = std::clamp(middle.x + (k % 3 - 1) * step, 0, width_ - s.width());
        p.y = std::clamp(middle.y + (k / 3 - 1) * step, 0, field_.height() - s.height());
        if (p.x == middle.x && p.y == middle.y) continue;
        work_left_ -= std::int64_t{2} * s.run_count() / step;
        const std::int64_t overlap = field_.overlap(s, p.x, p.y, step);
        if (overlap >= best.overlap) continue;
        best = {overlap, p};
        moved = true;
      }
    }
  }
  return best;
}

std::int64_t OverlapSearch::pair_overlap(std::size_t a, std::size_t b) {
  const PixelPlace &p = places_[a], &q = places_[b];
  const Silhouette &s = silhouette(a, p), &t = silhouette(b, q);
  if (p.sheet != q.sheet || std::max(p.x, q.x) >= std::min(p.x + s.width(), q.x + t.width())) return 0;
  const int dx = q.x - p.x, end = std::min(p.y + s.height(), q.y + t.height());
  std::int64_t sum = 0;
  for (int y = std::max(p.y, q.y); y < end; ++y) {
    const auto &one = s.rows()[static_cast<std::size_t>(y - p.y)], &other = t.rows()[static_cast<std::size_t>(y - q.y)];
    for (auto i = one.begin(), j = other.begin(); i != one.end() && j != other.end();) {
      sum += std::max(0, std::min(i->end, j->end + dx) - std::max(i->first, j->first + dx));
      if (i->end < j->end + dx)
        ++i;
      else
        ++j;
    }
    work_left_ -= 2;
  }
  return sum;
}

void OverlapSearch::measure(std::size_t island) {
  for (std::size_t k = 0; k < places_.size(); ++k) {
    if (k != island) overlaps_[pair(island, k)] = overlaps_[pair(k, island)] = pair_overlap(island, k);
  }
}

std::int64_t OverlapSearch::overlap_of(std::size_t island) const {
  std::int64_t sum = 0;
  for (std::size_t k = 0; k < places_.size(); ++k) sum += overlaps_[pair(island, k)];
  return sum;
}

std::int64_t OverlapSearch::total_overlap() const {
  std::int64_t sum = 0;
  for (const std::int64_t overlap : overlaps_) sum += overlap;
  return sum;
}

}  // namespace triskin::fabrication
