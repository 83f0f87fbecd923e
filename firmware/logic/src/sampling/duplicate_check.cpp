// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/duplicate_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace triskin::fw {
namespace {

struct Points {
  std::array<float, ad7147::kStages> offset{}, sum{};  // the sums are deviations from 65,536
  std::size_t count = 0;
};

using Values = std::array<float, ad7147::kStages>;

float dot(const Values& a, const Values& b, std::size_t count) {
  float sum = 0.0F;
  for (std::size_t k = 0; k < count; ++k) sum += a[k] * b[k];
  return sum;
}

void subtract_share(Values& from, const Values& direction, std::size_t count) {
  const float share = dot(from, direction, count) / dot(direction, direction, count);
  for (std::size_t k = 0; k < count; ++k) from[k] -= share * direction[k];
}

// What the best parabola over the offsets leaves of the sums: powers of the offset, made orthogonal to each other
// (Gram-Schmidt), are taken away one after another.
Values residuals_of_parabola(const Points& points) {
  constexpr std::size_t kPowers = 3;
  constexpr float kMiddle = ad7147::kMaxOffset / 2.0F;
  constexpr float kNothing = 0.01F;  // Unequal offsets leave at least 0.1 of a power, rounding at most 0.001.
  std::array<Values, kPowers> powers{};
  std::size_t used = 0;
  Values power{};
  power.fill(1.0F);
  Values residuals = points.sum;
  for (std::size_t degree = 0; degree < kPowers; ++degree) {
    powers[used] = power;
    for (std::size_t k = 0; k < points.count; ++k) power[k] *= points.offset[k] - kMiddle;
    for (std::size_t lower = 0; lower < used; ++lower) subtract_share(powers[used], powers[lower], points.count);
    if (dot(powers[used], powers[used], points.count) < kNothing) break;  // as many offsets as powers, or fewer
    subtract_share(residuals, powers[used], points.count);
    ++used;
  }
  return residuals;
}

}  // namespace

float DuplicateCheck::residual_counts(const ad7147::Results& other, const ad7147::Results& used,
                                      const ad7147::Offsets& offsets) {
  Points points;
  int outliers = 0;
  for (std::size_t t = 0; t < used.size(); ++t) {
    const std::int32_t deviation = other[t] + used[t] - 2 * static_cast<std::int32_t>(ad7147::kMidScale);
    if (std::abs(deviation) > kMaxDeviation_counts) ++outliers;
    if (!ad7147::in_range(other[t]) || !ad7147::in_range(used[t])) continue;
    points.offset[points.count] = static_cast<float>(offsets[t]);
    points.sum[points.count] = static_cast<float>(deviation);
    ++points.count;
  }
  if (outliers > kMaxOutliers) return std::numeric_limits<float>::infinity();
  if (points.count < kMinCompared) return 0.0F;
  Values residuals = residuals_of_parabola(points);
  for (int k = 0; k < kMaxOutliers; ++k) {
    std::size_t worst = 0;
    for (std::size_t p = 1; p < points.count; ++p) {
      if (std::abs(residuals[p]) > std::abs(residuals[worst])) worst = p;
    }
    --points.count;
    points.offset[worst] = points.offset[points.count];
    points.sum[worst] = points.sum[points.count];
    residuals = residuals_of_parabola(points);
  }
  float sum = 0.0F;
  for (std::size_t p = 0; p < points.count; ++p) sum += std::abs(residuals[p]);
  return sum / static_cast<float>(points.count);
}

DuplicateCheck::Verdict DuplicateCheck::compare(const ad7147::Results& other, const ad7147::Results& used,
                                                const ad7147::Offsets& offsets) {
  if (residual_counts(other, used, offsets) <= kMaxResidual_counts) {
    suspicions_ = 0;
    return Verdict::kSingle;
  }
  if (++suspicions_ < kMinSuspicions) return Verdict::kSuspected;
  suspicions_ = kMinSuspicions - 1;
  return Verdict::kDuplicate;
}

}  // namespace triskin::fw
