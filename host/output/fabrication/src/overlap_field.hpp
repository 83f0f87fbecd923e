// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "silhouette.hpp"

namespace triskin::fabrication {

/// Says for every place of an island on a sheet how much it would overlap the islands that lie there, each counted with
/// its weight. The field keeps the sums of the weights along each row, so that a run costs two look-ups, and the same
/// sums in pixels kCoarse times as large, with which a look at all places begins. A field is used for one island after
/// the other, because each counts the others with weights of its own.
class OverlapField {
 public:
  static constexpr int kCoarse = 6;

  /// Empties the field and gives it this size in pixels. Cost: linear in the size.
  void clear(int width, int height);
  /// Adds an island; it must lie within the field. Call finish() after the last. Cost: linear in its runs.
  void add(const Silhouette& s, const PixelPlace& at, int weight);
  void finish();

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

  /// Returns the weighted overlap in pixels, counted on every row_step-th row of the silhouette only. Cost: linear in
  /// the runs of these rows.
  [[nodiscard]] std::int64_t overlap(const Silhouette& s, int x, int y, int row_step = 1) const;

  /// Estimates the weighted overlap at the places x = 0, kCoarse, 2 · kCoarse, … of row y = kCoarse · coarse_row.
  /// `sums` says by its size for how many of them. Cost: linear in runs times places.
  void estimate(const Silhouette& coarse, int coarse_row, std::vector<float>& sums) const;

 private:
  [[nodiscard]] const int* row(int y) const { return &sums_[static_cast<std::size_t>(y) * row_length_]; }
  [[nodiscard]] int* row(int y) { return &sums_[static_cast<std::size_t>(y) * row_length_]; }

  int width_ = 0, height_ = 0;
  std::size_t row_length_ = 0, coarse_row_length_ = 0;
  std::vector<int> sums_, coarse_sums_;  // Entry x of a row is the sum of the weights of the pixels before x.
};

}  // namespace triskin::fabrication
