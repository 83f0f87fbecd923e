// SPDX-License-Identifier: GPL-3.0-or-later
#include "search/lookahead.hpp"

#include <cmath>
#include <cstring>

#include "kernels/vector_unit.hpp"

namespace triskin::placement {
namespace {

constexpr std::size_t kLanes = kLanesPerRow;
constexpr std::size_t kRows = kPartsPerAxis;
using Reals = float __attribute__((vector_size(4 * kLanes), may_alias));
using Flags = std::int32_t __attribute__((vector_size(4 * kLanes), may_alias));

// Returns the middle of part k of four, in half widths of the cell.
constexpr float middle(std::size_t k) {
  return 0.25F * (2.0F * static_cast<float>(k) + 1.0F) - 1.0F;
}

struct Layout {
  alignas(64) float x[kLanes], y[kLanes];
};
constexpr Layout kLayout = [] {
  Layout l{};
  for (std::size_t k = 0; k < kLanes; ++k) {
    l.x[k] = middle(k % kPartsPerAxis);
    l.y[k] = middle(k / kPartsPerAxis);
  }
  return l;
}();

// Tracks which half spaces hold in all rows: of a direction so far, of a pair, of a tile.
struct Truth {
  Flags direction[kRows], pair[kRows], tile[kRows];
};

[[gnu::always_inline]] inline void begin(Truth& t) {
  const Flags none = {};
  for (std::size_t r = 0; r < kRows; ++r) {
    t.direction[r] = t.tile[r] = none - 1;
    t.pair[r] = none;
  }
}

[[gnu::always_inline]] inline void finish(Truth& t, std::uint32_t ends) {
  const Flags none = {};
  for (std::size_t r = 0; r < kRows; ++r) {
    t.pair[r] |= t.direction[r];
    t.direction[r] = none - 1;
  }
  if ((ends & HalfSpace::kEndPair) == 0) return;
  for (std::size_t r = 0; r < kRows; ++r) {
    t.tile[r] &= t.pair[r];
    t.pair[r] = none;
  }
}

[[gnu::always_inline]] inline void count(const Lookahead::Sharp* next, std::size_t tiles, PartWord* words,
                                         std::int32_t* counts) {
  const Reals lane_x = *reinterpret_cast<const Reals*>(kLayout.x), lane_y = *reinterpret_cast<const Reals*>(kLayout.y),
              zero = {};
  const Flags none = {};
  Flags sum[kRows];
  for (Flags& s : sum) s = none;
  for (std::size_t t = 0; t < tiles; ++t) {
    Truth may, must;
    begin(may);
    begin(must);
    for (bool more = true; more; ++next) {
      const Reals row = next->level + next->x * lane_x + next->y * lane_y;
      for (std::size_t r = 0; r < kRows; ++r) {
        const Reals value = row + middle(r) * next->theta;
        may.direction[r] &= value >= zero;
        must.direction[r] &= value >= zero + next->sure;
      }
      if (next->ends == 0) continue;
      finish(may, next->ends);
      finish(must, next->ends);
      more = (next->ends & HalfSpace::kEndTile) == 0;
    }
    Flags word = none;
    for (std::size_t r = 0; r < kRows; ++r) {
      sum[r] -= may.tile[r];
      word |= (may.tile[r] & (1 << r)) | (must.tile[r] & (65536 << r));
    }
    std::memcpy(words[t].data(), &word, sizeof word);
  }
  for (std::size_t r = 0; r < kRows; ++r) {
    for (std::size_t k = 0; k < kLanes; ++k) counts[kLanes * r + k] = sum[r][k];
  }
}

using Count = void (*)(const Lookahead::Sharp*, std::size_t, PartWord*, std::int32_t*);

#define TRISKIN_COUNT(unit, target)                                                                           \
  target void count_##unit(const Lookahead::Sharp* h, std::size_t n, PartWord* words, std::int32_t* counts) { \
    count(h, n, words, counts);                                                                               \
  }
TRISKIN_FOR_VECTOR_UNITS(TRISKIN_COUNT)
#undef TRISKIN_COUNT

Lookahead::Sharp sharpen(const HalfSpace& h, const PartsView& view) {
  const double x = h.x * view.half[0], y = h.y * view.half[1], theta = h.theta * view.half[2];
  const double size = std::abs(x) + std::abs(y) + std::abs(theta);
  const double level = h.level + h.x * view.shift[0] + h.y * view.shift[1] + h.theta * view.shift[2];
  // The level includes a part's own half widths; 1e-6 is above the rounding of seven operations in single precision.
  const double slack = size / kPartsPerAxis + 1e-6 * (std::abs(level) + size);
  const auto sure = static_cast<float>((2.0 * slack + view.sure_mm) * (1.0 + 1e-6) + 1e-30);
  return {static_cast<float>(level + slack),
          static_cast<float>(x),
          static_cast<float>(y),
          static_cast<float>(theta),
          sure,
          h.ends};
}

}  // namespace

void Lookahead::run(const PartsView& view, std::span<const HalfSpace> halves, std::vector<PartWord>& words) {
  sharp_.clear();
  std::size_t tiles = 0;
  for (const HalfSpace& h : halves) {
    sharp_.push_back(sharpen(h, view));
    tiles += (h.ends & HalfSpace::kEndTile) != 0 ? 1 : 0;
  }
  words.resize(tiles);
  static const Count kCount = fastest(count_plain, count_avx2, count_avx512);
  kCount(sharp_.data(), tiles, words.data(), counts_.data());
}

}  // namespace triskin::placement
