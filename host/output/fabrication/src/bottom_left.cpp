// SPDX-License-Identifier: GPL-3.0-or-later
#include "bottom_left.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <optional>

namespace triskin::fabrication {
namespace {

constexpr std::size_t kWord = 64;

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

// Lays the island on the sheet in the turn that ends lowest; false if it fits in none.
bool place(const std::vector<Silhouette>& turns, Sheet& sheet, PixelPlace& place) {
  const Silhouette* best = nullptr;
  int top = std::numeric_limits<int>::max();
  for (int turn = 0; turn < kTurns; ++turn) {
    const Silhouette& s = turns[static_cast<std::size_t>(turn)];
    const auto found = sheet.lowest(s, top - 1);
    if (!found) continue;
    best = &s;
    place.turn = turn;
    place.x = found->x;
    place.y = found->y;
    top = place.y + s.height();
  }
  if (best == nullptr) return false;
  sheet.take(*best, {place.x, place.y});
  return true;
}

}  // namespace

std::vector<PixelPlace> bottom_left(const Silhouettes& silhouettes, const std::vector<std::size_t>& order, int width,
                                    int height) {
  std::vector<PixelPlace> places(silhouettes.size());
  std::vector<Sheet> sheets;
  for (const std::size_t island : order) {
    std::size_t number = 0;
    while (number < sheets.size() && !place(silhouettes[island], sheets[number], places[island])) ++number;
    if (number == sheets.size()) {
      sheets.emplace_back(width, height);
      place(silhouettes[island], sheets.back(), places[island]);
    }
    places[island].sheet = static_cast<int>(number);
  }
  return places;
}

}  // namespace triskin::fabrication
