// SPDX-License-Identifier: GPL-3.0-or-later
#include "search/cell_expander.hpp"

#include <algorithm>
#include <cstring>

#include "search/slices.hpp"

namespace triskin::placement {
namespace {

constexpr int kMaxPasses = 4;
constexpr int kGenerationsWithout = 1;
constexpr double kWorthAnotherPass = 0.7;
constexpr int kMaxPartsOfSlice = 8, kMaxPartsOfCube = 8;  // Both values limit the parts of one child.

}  // namespace

OpenParts<int> CellExpander::open_among(const Cell& cell, const PartIndex& low, const PartIndex& high) const {
  const int need = best_ + 1 - cell.certain;
  const auto count = [&](int x, int y, int t) { return cell.list ? lookahead_.count(x, y, t) : raster_.count(x, y); };
  return open_parts(low, high, count, [need](int n) { return n >= need; });
}

void CellExpander::expand(Cell cell, const Demand& demand, int best, bool keep_closed, Expansion& result) {
  demand_ = demand;
  best_ = best;
  keep_closed_ = keep_closed;
  result_ = &result;
  if (cell.list)
    refine(cell);
  else if (cell.promising)
    refine_slice(cell);
  else
    bound_slice(cell);
  result.best = best_;
}

// Computes only the bound: a better value found meanwhile closes many slices before they are divided.
void CellExpander::bound_slice(Cell& cell) {
  ++result_->passes;
  set_frame(cell.box);
  if (raster_.bytes_for(frame_) > SliceRaster::kMaxBytes) return leave_open(cell);
  raster_.scan(frame_);
  parts_ = {SliceRaster::kSteps, SliceRaster::kSteps, 1};
  const PartIndex best = best_part(parts_, [this](int x, int y) { return raster_.count(x, y); });
  const MotionBox part = part_box(cell.box, parts_, best, {best[0] + 1, best[1] + 1, 1});
  cell.promising = Motion{part.center(0), part.center(1), part.center(2)};
  cell.bound = std::min(cell.bound, raster_.count(best[0], best[1]));
  result_->children.push_back(std::move(cell));
}

void CellExpander::leave_open(const Cell& cell) {
  result_->too_large = true;
  result_->unresolved_bound = std::max(result_->unresolved_bound, cell.bound);
  result_->tied_slices.emplace_back(cell.bound, cell.box);
  close(cell.box);
}

void CellExpander::refine_slice(Cell& cell) {
  if (demand_.rising) try_motion(*cell.promising);
  set_frame(cell.box);
  raster_.scan(frame_);
  raster_.collect(frame_);
  cell.certain = raster_.certain();
  parts_ = {SliceRaster::kSteps, SliceRaster::kSteps, 1};
  note_tie(cell);
  chosen_.clear();
  for (std::uint32_t k = 0; k < raster_.border().size(); ++k) chosen_.push_back(k);
  divide_slice(cell, {0, 0, 0}, parts_, 0, 0);
}

// Notes a slice that may hold as many tiles as the best; a search for ties begins with it.
void CellExpander::note_tie(const Cell& cell) {
  int most = 0;
  for (int y = 0; y < parts_[1]; ++y) {
    for (int x = 0; x < parts_[0]; ++x) most = std::max(most, raster_.count(x, y));
  }
  if (cell.certain + most >= best_) result_->tied_slices.emplace_back(cell.certain + most, cell.box);
}

// Makes children: small boxes around open parts, of which at least half are open. chosen_[first_chosen …) may be
// undecided among the parts; `certain` more tiles than in the slice are certain there.
void CellExpander::divide_slice(const Cell& cell, const PartIndex& low, const PartIndex& high, std::size_t first_chosen,
                                int certain) {
  const OpenParts<int> open = open_among(cell, low, high);
  const MotionBox whole = part_box(cell.box, parts_, low, high);
  if (open.count == 0) return close(whole);
  const MotionBox box = part_box(cell.box, parts_, open.low, open.high);
  close_clipped(whole, box);
  const std::size_t last_chosen = chosen_.size();
  certain += choose_border(open.low, open.high, first_chosen, last_chosen);
  if (open.well_filled(kMaxPartsOfSlice)) {
    add_slice_child(cell, box, open, last_chosen, certain);
  } else {
    const auto [first_high, second_low] = open.halves(longest_axis(weighted_half(box), open.size()));
    divide_slice(cell, second_low, open.high, last_chosen, certain);
    divide_slice(cell, open.low, first_high, last_chosen, certain);
  }
  chosen_.resize(last_chosen);
}

// Does what choose() does, for the border tiles of a slice.
int CellExpander::choose_border(const PartIndex& low, const PartIndex& high, std::size_t first, std::size_t last) {
  const auto lanes = static_cast<std::uint32_t>((1U << high[0]) - (1U << low[0]));
  BlockWords wanted{};
  for (int y = low[1]; y < high[1]; ++y) wanted[y] = lanes;
  int certain = 0;
  for (std::size_t n = first; n < last; ++n) {
    const SliceRaster::Border& border = raster_.border()[chosen_[n]];
    BlockWords may, must;
    std::memcpy(&may, border.may.data(), sizeof may);
    std::memcpy(&must, border.must.data(), sizeof must);
    if (!any(wanted & ~must))
      ++certain;
    else if (any(wanted & may))
      chosen_.push_back(chosen_[n]);
  }
  return certain;
}

// Edges are looked up when a child is opened, since most children are pruned earlier by a better value.
void CellExpander::add_slice_child(const Cell& cell, const MotionBox& box, const OpenParts<int>& open,
                                   std::size_t first_chosen, int certain) {
  auto list = std::make_shared<CellList>();
  list->tiles.reserve(chosen_.size() - first_chosen);
  const auto lanes = static_cast<std::uint32_t>((1U << open.high[0]) - (1U << open.low[0]));
  const double reach_mm = slice_child_reach_mm(polygon_, grid_, box, frame_.certain_mm);
  for (std::size_t n = first_chosen; n < chosen_.size(); ++n) {
    const SliceRaster::Border& border = raster_.border()[chosen_[n]];
    std::uint32_t may_not = 0;
    for (int y = open.low[1]; y < open.high[1]; ++y) may_not |= ~border.may[static_cast<std::size_t>(y)] & lanes;
    // A tile that may hold has its centre inside at the middle of the part, and so everywhere in the part where it
    // holds.
    list->tiles.push_back({grid_.center(border.tile), border.tile, may_not == 0, 0, 0});
  }
  result_->children.push_back({box, cell.certain + certain, std::min(cell.bound, cell.certain + open.most),
                               std::move(list), reach_mm, std::nullopt, kGenerationsWithout});
}

void CellExpander::refine(Cell& cell) {
  const CellList* source = cell.list.get();
  CellList* to = &lists_[0];
  if (cell.reach_mm > 0.0) {
    list_with_edges(polygon_, edges_, cell.box, cell.reach_mm, *cell.list, lists_[1]);
    source = &lists_[1];
  }
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    ++result_->passes;
    set_frame(cell.box);
    const CellFilter::Outcome found = filter_.filter(frame_, *source, best_ + 1 - cell.certain, *to, boxes_, halves_);
    if (!found.alive) return close(cell.box);
    cell.certain += found.certain;
    cell.bound = cell.certain + static_cast<int>(to->tiles.size());
    note_value(cell.certain + found.free_at_center);
    if (cell.bound <= best_) return close(cell.box);
    const double before = std::ranges::max(weighted_half(cell.box));
    const MotionBox whole = cell.box;
    if (!contraction_.clip(cell.box, boxes_, best_ + 1 - cell.certain)) return close(whole);
    close_clipped(whole, cell.box);
    source = to;
    to = to == &lists_[0] ? &lists_[1] : &lists_[0];
    if (std::ranges::max(weighted_half(cell.box)) > kWorthAnotherPass * before) break;
  }
  CellList& list = source == &lists_[0] ? lists_[0] : lists_[1];
  if (cell.without_conflicts > 0)
    --cell.without_conflicts;
  else if (demand_.conflicts && closed_by_conflicts(cell, list))
    return;
  look_ahead(cell, list);
}

// Returns true if the cell is closed, or divided by its angles alone.
bool CellExpander::closed_by_conflicts(Cell& cell, CellList& list) {
  const ConflictBound::Verdict verdict = conflicts_.judge(frame_, list, best_ + 1 - cell.certain);
  if (verdict == ConflictBound::Verdict::kClosed) {
    close(cell.box);
    return true;
  }
  drop_dead(list);
  cell.bound = std::min(cell.bound, cell.certain + static_cast<int>(list.tiles.size()));
  if (cell.bound <= best_) {
    close(cell.box);
    return true;
  }
  if (!conflicts_.is_promising()) cell.without_conflicts = kGenerationsWithout;
  if (verdict == ConflictBound::Verdict::kOpen) return false;
  halve_angles(cell, list);
  return true;
}

// Drops the same tiles from the list and from halves_, which has their constraints in the same order.
void CellExpander::drop_dead(CellList& list) {
  const std::vector<std::uint8_t>& dead = conflicts_.dead();
  if (std::ranges::none_of(dead, [](std::uint8_t d) { return d != 0; })) return;
  CellList kept;
  std::size_t halves = 0, kept_halves = 0;
  for (std::size_t t = 0; t < dead.size(); ++t) {
    const std::size_t first = halves;
    while ((halves_[halves++].ends & HalfSpace::kEndTile) == 0) continue;
    if (dead[t] != 0) continue;
    std::copy(halves_.begin() + static_cast<std::ptrdiff_t>(first),
              halves_.begin() + static_cast<std::ptrdiff_t>(halves),
              halves_.begin() + static_cast<std::ptrdiff_t>(kept_halves));
    kept_halves += halves - first;
    kept.add(list, t);
  }
  halves_.resize(kept_halves);
  list = std::move(kept);
}

void CellExpander::halve_angles(const Cell& cell, const CellList& list) {
  if (unresolved(cell)) return;
  chosen_.resize(list.tiles.size());
  for (std::uint32_t t = 0; t < chosen_.size(); ++t) chosen_[t] = t;
  const std::shared_ptr<const CellList> shared = chosen_list(list, 0);
  chosen_.clear();
  for (const int half : {1, 0}) {
    const MotionBox box = part_box(cell.box, {1, 1, 2}, {0, 0, half}, {1, 1, half + 1});
    result_->children.push_back({box, cell.certain, cell.bound, shared});
  }
}

// Near the rounding pad a cell stays open in the bound.
bool CellExpander::unresolved(const Cell& cell) {
  if (std::ranges::max(weighted_half(cell.box)) >= demand_.resolution_mm) return false;
  result_->unresolved_bound = std::max(result_->unresolved_bound, cell.bound);
  close(cell.box);
  return true;
}

void CellExpander::look_ahead(Cell& cell, const CellList& list) {
  if (unresolved(cell)) return;
  lookahead_.run(parts_view(frame_, cell.box), halves_, words_);
  forget_certain_outside(list.tiles, words_);
  chosen_.clear();
  for (std::uint32_t t = 0; t < list.tiles.size(); ++t) chosen_.push_back(t);
  parts_ = {kPartsPerAxis, kPartsPerAxis, kPartsPerAxis};
  divide(cell, list, {0, 0, 0}, parts_, 0, 0);
}

// Adds to the stack those of chosen_[first, last) that are undecided in the parts; returns how many are certain there.
int CellExpander::choose(const PartIndex& low, const PartIndex& high, std::size_t first, std::size_t last) {
  const PartWord parts = wanted_parts(low, high);
  BlockWords wanted;
  std::memcpy(&wanted, parts.data(), sizeof wanted);
  int certain = 0;
  for (std::size_t n = first; n < last; ++n) {
    BlockWords word;
    std::memcpy(&word, words_[chosen_[n]].data(), sizeof word);
    if (!any(wanted & ~(word >> 16)))
      ++certain;
    else if (any(wanted & word))
      chosen_.push_back(chosen_[n]);
  }
  return certain;
}

// Does what divide_slice() does, for cubes. chosen_[first_chosen …) may be undecided in the parts; `certain` more
// tiles than in the cell are certain there.
void CellExpander::divide(const Cell& cell, const CellList& list, const PartIndex& low, const PartIndex& high,
                          std::size_t first_chosen, int certain) {
  const MotionBox whole = part_box(cell.box, parts_, low, high);
  const OpenParts<int> open = open_among(cell, low, high);
  if (open.count == 0) return close(whole);
  const MotionBox box = part_box(cell.box, parts_, open.low, open.high);
  close_clipped(whole, box);
  const std::size_t last_chosen = chosen_.size();
  certain += choose(open.low, open.high, first_chosen, last_chosen);
  if (open.well_filled(kMaxPartsOfCube)) {
    result_->children.push_back({box, cell.certain + certain, std::min(cell.bound, cell.certain + open.most),
                                 chosen_list(list, last_chosen), 0.0, std::nullopt, cell.without_conflicts});
  } else {
    const auto [first_high, second_low] = open.halves(longest_axis(weighted_half(box), open.size()));
    divide(cell, list, second_low, open.high, last_chosen, certain);
    divide(cell, list, open.low, first_high, last_chosen, certain);
  }
  chosen_.resize(last_chosen);
}

// Copies the top of the stack into a list of its own.
std::shared_ptr<const CellList> CellExpander::chosen_list(const CellList& list, std::size_t first_chosen) const {
  auto to = std::make_shared<CellList>();
  to->tiles.reserve(chosen_.size() - first_chosen);
  to->pairs.reserve(2 * (chosen_.size() - first_chosen));
  for (std::size_t n = first_chosen; n < chosen_.size(); ++n) to->add(list, chosen_[n]);
  return to;
}

void CellExpander::note_value(int value) {
  const Motion motion{frame_.center[0], frame_.center[1], frame_.center[2]};
  if (value == best_) result_->as_good.push_back(motion);
  if (value > best_) try_motion(motion);
}

// The count is made at the very motion that is returned; the filtered lists are only a shortcut.
void CellExpander::try_motion(const Motion& motion) {
  const int counted = evaluator_.count(motion, demand_.inset_mm - demand_.tolerance_mm);
  if (counted == best_) result_->as_good.push_back(motion);
  if (counted <= best_) return;
  result_->better.emplace_back(counted, motion);
  if (demand_.rising) return;
  best_ = counted;
  result_->as_good.clear();
}

// The search may use half the tolerance: a tile that holds with it leaves a box of motions that count, and the middle
// of a small cell lies in that box. Without it, only luck would hit a single motion.
void CellExpander::set_frame(const MotionBox& box) {
  const double spare = demand_.rising ? 0.0 : 0.5 * demand_.tolerance_mm;
  frame_.set(polygon_, grid_, box, demand_.inset_mm - spare, demand_.inset_mm - demand_.tolerance_mm);
  frame_.certain_mm = demand_.rising ? demand_.last_inset_mm : frame_.sufficient_mm;
}

std::array<double, 3> CellExpander::weighted_half(const MotionBox& box) const {
  return half_extents_mm(box, polygon_.radius_mm);
}

void CellExpander::close(const MotionBox& box) {
  if (keep_closed_) result_->closed.push_back(box);
}

// Closes the slabs that were cut off.
void CellExpander::close_clipped(MotionBox whole, const MotionBox& clipped) {
  if (!keep_closed_) return;
  for (std::size_t k = 0; k < 3; ++k) {
    MotionBox slab = whole;
    slab.high[k] = clipped.low[k];
    if (slab.low[k] < slab.high[k]) close(slab);
    slab = whole;
    slab.low[k] = clipped.high[k];
    if (slab.low[k] < slab.high[k]) close(slab);
    whole.low[k] = clipped.low[k];
    whole.high[k] = clipped.high[k];
  }
}

}  // namespace triskin::placement
