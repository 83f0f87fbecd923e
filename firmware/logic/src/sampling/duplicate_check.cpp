// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/duplicate_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace triskin::fw {
namespace {

using Values = std::array<float, ad7147::kStages>;

struct Points {
  ad7147::Offsets offset{};
  Values result{}, sum{};  // of the used input from mid scale; of both inputs from 65,536
  std::size_t count = 0;

  void remove(std::size_t k) {
    --count;
    offset[k] = offset[count];
    result[k] = result[count];
    sum[k] = sum[count];
  }
  // Taxels beyond the first of their offset: each is one comparison.
  [[nodiscard]] std::size_t comparisons() const {
    std::size_t repeated = 0;
    for (std::size_t k = 1; k < count; ++k) {
      const auto* const end = offset.begin() + k;
      if (std::find(offset.begin(), end, offset[k]) != end) ++repeated;
    }
    return repeated;
  }
};

// What the values deviate from the mean of those with the same offset.
Values within_offsets(const Points& points, const Values& values) {
  Values deviations{};
  for (std::size_t k = 0; k < points.count; ++k) {
    float sum = 0.0F, number = 0.0F;
    for (std::size_t other = 0; other < points.count; ++other) {
      if (points.offset[other] != points.offset[k]) continue;
      sum += values[other];
      number += 1.0F;
    }
    deviations[k] = values[k] - sum / number;
  }
  return deviations;
}

// The sums without the mean of each offset and without what grows with the result, the difference of the gains.
Values residuals_of(const Points& points) {
  const Values result = within_offsets(points, points.result);
  Values residuals = within_offsets(points, points.sum);
  float product = 0.0F, square = 0.0F;
  for (std::size_t k = 0; k < points.count; ++k) {
    product += residuals[k] * result[k];
    square += result[k] * result[k];
  }
  if (square == 0.0F) return residuals;
  const float gains = std::clamp(product / square, -DuplicateCheck::kMaxGain, DuplicateCheck::kMaxGain);
  for (std::size_t k = 0; k < points.count; ++k) residuals[k] -= gains * result[k];
  return residuals;
}

}  // namespace

ad7147::Offsets DuplicateCheck::offsets(const ad7147::Offsets& fitting) const {
  ad7147::Offsets rounded{};
  for (std::size_t t = 0; t < fitting.size(); ++t) {
    const int code = comparison_ == 0 ? fitting[t] / kCodeSteps * kCodeSteps + kCodeSteps / 2
                                      : (fitting[t] + kCodeSteps / 2) / kCodeSteps * kCodeSteps;
    rounded[t] = static_cast<std::uint8_t>(std::min<int>(code, ad7147::kMaxOffset));
  }
  return rounded;
}

float DuplicateCheck::residual_counts(const ad7147::Results& other, const ad7147::Results& used,
                                      const ad7147::Offsets& offsets) {
  Points points;
  int outliers = 0;
  for (std::size_t t = 0; t < used.size(); ++t) {
    const std::int32_t deviation = other[t] + used[t] - 2 * static_cast<std::int32_t>(ad7147::kMidScale);
    if (std::abs(deviation) > kMaxDeviation_counts) ++outliers;
    if (!ad7147::in_range(other[t]) || !ad7147::in_range(used[t])) continue;
    points.offset[points.count] = offsets[t];
    points.result[points.count] = static_cast<float>(used[t]) - static_cast<float>(ad7147::kMidScale);
    points.sum[points.count] = static_cast<float>(deviation);
    ++points.count;
  }
  if (outliers > kMaxOutliers) return std::numeric_limits<float>::infinity();
  if (points.comparisons() < kMinCompared + kMaxOutliers) return 0.0F;
  Values residuals = residuals_of(points);
  for (int k = 0; k < kMaxOutliers; ++k) {
    std::size_t worst = 0;
    for (std::size_t p = 1; p < points.count; ++p) {
      if (std::abs(residuals[p]) > std::abs(residuals[worst])) worst = p;
    }
    points.remove(worst);
    residuals = residuals_of(points);
  }
  float sum = 0.0F;
  for (std::size_t p = 0; p < points.count; ++p) sum += std::abs(residuals[p]);
  return sum / static_cast<float>(points.comparisons());
}

DuplicateCheck::Verdict DuplicateCheck::compare(const ad7147::Results& other, const ad7147::Results& used,
                                                const ad7147::Offsets& offsets) {
  if (residual_counts(other, used, offsets) > kMaxResidual_counts) {
    comparison_ = 0;
    if (++suspicions_ < kMinSuspicions) return Verdict::kUndecided;
    suspicions_ = kMinSuspicions - 1;
    return Verdict::kDuplicate;
  }
  if (++comparison_ < kComparisons) return Verdict::kUndecided;
  comparison_ = suspicions_ = 0;
  return Verdict::kSingle;
}

}  // namespace triskin::fw
