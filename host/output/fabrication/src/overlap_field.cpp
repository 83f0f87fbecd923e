// SPDX-License-Identifier: GPL-3.0-or-later
#include "overlap_field.hpp"

#include <algorithm>

namespace triskin::fabrication {

void OverlapField::clear(int width, int height) {
  width_ = width;
  height_ = height;
  row_length_ = static_cast<std::size_t>(width) + 1;
  // A coarse silhouette can stick out of the sheet by nearly two coarse pixels; there the field is empty.
  coarse_row_length_ = static_cast<std::size_t>(width / kCoarse) + 4;
  sums_.assign(static_cast<std::size_t>(height) * row_length_, 0);
  coarse_sums_.assign((static_cast<std::size_t>(height / kCoarse) + 4) * coarse_row_length_, 0);
}

void OverlapField::add(const Silhouette& s, const PixelPlace& at, int weight) {
  for (int r = 0; r < s.height(); ++r) {
    int* steps = row(at.y + r) + at.x;  // Until finish() is called a row stores the steps of the weight.
    for (const Run& run : s.rows()[static_cast<std::size_t>(r)]) {
      steps[run.first] += weight;
      steps[run.end] -= weight;
    }
  }
}

void OverlapField::finish() {
  for (int y = 0; y < height_; ++y) {
    int* sums = row(y);
    int weight = 0, sum = 0;
    for (std::size_t x = 0; x < row_length_; ++x) {
      const int step = sums[x];
      sums[x] = sum;
      weight += step;
      sum += weight;
    }
    int* coarse = &coarse_sums_[static_cast<std::size_t>(y / kCoarse) * coarse_row_length_];
    for (std::size_t x = 0; x < coarse_row_length_; ++x) coarse[x] += sums[std::min(x * kCoarse, row_length_ - 1)];
  }
}

std::int64_t OverlapField::overlap(const Silhouette& s, int x, int y, int row_step) const {
  std::int64_t sum = 0;
  for (int r = row_step / 2; r < s.height(); r += row_step) {
    const int* sums = row(y + r) + x;
    for (const Run& run : s.rows()[static_cast<std::size_t>(r)]) sum += sums[run.end] - sums[run.first];
  }
  return sum;
}

void OverlapField::estimate(const Silhouette& coarse, int coarse_row, std::vector<float>& sums) const {
  std::ranges::fill(sums, 0.0F);
  const int* row_sums = &coarse_sums_[static_cast<std::size_t>(coarse_row) * coarse_row_length_];
  for (const auto& runs : coarse.rows()) {
    for (const Run& run : runs) {
      const int *end = row_sums + run.end, *first = row_sums + run.first;
      for (std::size_t x = 0; x < sums.size(); ++x) sums[x] += static_cast<float>(end[x] - first[x]);
    }
    row_sums += coarse_row_length_;
  }
}

}  // namespace triskin::fabrication
