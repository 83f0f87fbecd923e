// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_overlap.hpp"

#include <cmath>

namespace triskin::mechanics {
namespace {

// Contacts with one centre have no direction in which they could part.
constexpr double kOneCentre_mm = 1e-9;

// Calls `use` with the indices, the offset and the overlap of each pair of contacts that overlap.
template <typename Use>
void for_overlaps(std::span<const FitContact> contacts, const TaxelResponse& response, const Use& use) {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Eigen::Vector2d offset = contacts[i].position_mm - contacts[j].position_mm;
      const auto a = static_cast<Eigen::Index>(i), b = static_cast<Eigen::Index>(j);
      const double overlap_mm = response.contact_radii_mm[a] + response.contact_radii_mm[b] - offset.norm();
      if (overlap_mm > 0.0) use(a, b, offset, overlap_mm);
    }
  }
}

}  // namespace

double overlap_objective(const FitPriors& priors, std::span<const FitContact> contacts, const TaxelResponse& response) {
  double sum = 0.0;
  for_overlaps(contacts, response, [&](Eigen::Index, Eigen::Index, const Eigen::Vector2d&, double overlap_mm) {
    sum += std::pow(overlap_mm / priors.overlap_sd_mm, 2);
  });
  return sum;
}

void add_overlap(const FitPriors& priors, std::span<const FitContact> contacts, const TaxelResponse& response,
                 Eigen::MatrixXd& matrix, Eigen::VectorXd& half_gradient) {
  for_overlaps(contacts, response, [&](Eigen::Index i, Eigen::Index j, const Eigen::Vector2d& offset, double overlap) {
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(half_gradient.size());
    const double distance = offset.norm();
    const Eigen::Index first = kParametersPerContact * i, second = kParametersPerContact * j;
    if (distance > kOneCentre_mm) {
      slope.segment<2>(first) = -offset / distance;
      slope.segment<2>(second) = offset / distance;
    }
    slope.segment<2>(first + 2) = response.radius_slopes_mm.row(i);
    slope.segment<2>(second + 2) = response.radius_slopes_mm.row(j);
    slope /= priors.overlap_sd_mm;
    matrix += slope * slope.transpose();
    half_gradient += slope * overlap / priors.overlap_sd_mm;
  });
}

}  // namespace triskin::mechanics
