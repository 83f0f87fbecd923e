// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mechanics/pressure_contacts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "footprint_fit.hpp"
#include "surface_layout.hpp"
#include "triskin/base/error.hpp"
#include "units.hpp"

namespace triskin::mechanics {
namespace {

constexpr std::size_t kMaxFittedTaxels = 30, kMaxFootprints = 3;
// The first search reaches this far around the strongest taxel, the repeated ones after other contacts have changed.
constexpr double kFirstReach_mm = 6.0, kNextReach_mm = 3.0;
constexpr int kRounds = 4;
// An additional contact must reduce the sum of squares by at least this many variances.
constexpr double kWantedGain = 100.0;
// A single taxel supports one contact; two contacts need four taxels, or the second would fit noise.
constexpr std::size_t kTaxelsForOne = 2;
// Round contacts explain a group if they leave less than this share of its sum of squares.
constexpr double kMaxUnexplained = 0.05;
// For the smallest contacts that are summed, the sum over taxels errs by this share (docs/calibration.md).
constexpr double kSumErrorShare = 0.05;
// The force of a contact equals the sum over the taxels around it within a factor e to the power of this. Without this
// bound, a light touch on one taxel could be explained by a huge force far beside it.
constexpr double kSumLogSd = 0.4, kSumReach_mm = 15.0;

using Fits = std::vector<FootprintFit>;

void check(const PressureOptions& o, std::size_t taxels, std::span<const std::size_t> pressed) {
  for (const double v :
       {o.noise_kpa, o.model_error, o.taxel_area_mm2, o.max_link_mm, o.contact_radius_mm, o.contact_radius_log_sd}) {
    if (!(v > 0.0) || !std::isfinite(v)) throw InputError("contacts: an option is not a positive number");
  }
  for (const std::size_t t : pressed) {
    if (t >= taxels) throw InputError(fmt::format("contacts: taxel {} is pressed, and there are {}", t, taxels));
  }
}

// Contacts are added to a group while they explain much more; each one is fitted to the residual of the others.
class GroupFit {
 public:
  GroupFit(const Footprint& footprint, const SurfaceLayout& layout, const PressureOptions& options)
      : footprint_(footprint), layout_(layout), options_(options) {
    sd_ = std::hypot(options.noise_kpa, options.model_error * std::max(0.0, layout.values.maxCoeff()));
  }
  // Returns nothing if round contacts do not explain the group, which has this many pressed taxels.
  [[nodiscard]] Fits run(std::size_t taxels) const {
    Fits fits;
    double left = layout_.values.squaredNorm();
    while (fits.size() < kMaxFootprints && (fits.empty() || taxels >= kTaxelsForOne * (fits.size() + 1))) {
      Fits more = with_one_more(fits);
      if (more.size() == fits.size()) break;
      const double left_by_more = rest(more, more.size()).squaredNorm();
      if (!(left - left_by_more > kWantedGain * sd_ * sd_)) break;
      fits = std::move(more);
      left = left_by_more;
    }
    if (!(left < kMaxUnexplained * layout_.values.squaredNorm())) fits.clear();
    return fits;
  }

 private:
  // Returns the values that all contacts but one leave unexplained.
  [[nodiscard]] Eigen::VectorXd rest(const Fits& fits, std::size_t but) const {
    Eigen::VectorXd rest = layout_.values;
    for (std::size_t k = 0; k < fits.size(); ++k) {
      if (k != but) rest -= predicted_kpa(footprint_, layout_.places_mm, fits[k]);
    }
    return rest;
  }
  [[nodiscard]] std::optional<FootprintFit> fitted(const Eigen::VectorXd& kpa, const Eigen::Vector2d& about,
                                                   double reach_mm) const {
    double sum_kpa = 0.0;
    for (std::size_t t = 0; t < layout_.places_mm.size(); ++t) {
      if ((layout_.places_mm[t] - about).norm() < kSumReach_mm) sum_kpa += kpa[static_cast<Eigen::Index>(t)];
    }
    if (!(sum_kpa > 0.0)) return std::nullopt;
    const FootprintPrior prior{std::log(options_.contact_radius_mm), options_.contact_radius_log_sd,
                               std::log(sum_kpa * options_.taxel_area_mm2 / kKpaMm2PerN), kSumLogSd};
    return fit_footprint(footprint_, {layout_.places_mm, kpa, sd_}, prior, about, reach_mm);
  }
  [[nodiscard]] Fits with_one_more(Fits fits) const {
    const Eigen::VectorXd left = rest(fits, fits.size());
    Eigen::Index strongest = 0;
    if (!(left.maxCoeff(&strongest) > 0.0)) return fits;
    const auto added = fitted(left, layout_.places_mm[static_cast<std::size_t>(strongest)], kFirstReach_mm);
    if (!added) return fits;
    fits.push_back(*added);
    for (int round = 0; round < kRounds && fits.size() > 1; ++round) {
      for (std::size_t k = 0; k < fits.size(); ++k) {
        if (const auto again = fitted(rest(fits, k), fits[k].position_mm, kNextReach_mm)) fits[k] = *again;
      }
    }
    return fits;
  }

  const Footprint& footprint_;
  const SurfaceLayout& layout_;
  const PressureOptions& options_;
  double sd_ = 0.0;
};

ContactEstimate estimate_of(const FootprintFit& fit) {
  ContactEstimate e;
  e.position_mm = fit.position_mm;
  e.position_sd_mm = fit.position_sd_mm;
  e.force_n = fit.force_n;
  e.force_sd_n = fit.force_sd_n;
  e.contact_radius_mm = fit.radius_mm;
  return e;
}

// Replaces a group by one contact with the sum of its taxels at their centroid.
PressureContact summed(const SurfaceTaxels& taxels, const TaxelGroup& group, const PressureOptions& options) {
  PressureContact sum;
  sum.contact.normal = Eigen::Vector3d::Zero();
  double kpa = 0.0, squares = 0.0;
  for (const std::size_t t : group) {
    const double weight = std::max(taxels.values[t], 0.0);
    kpa += weight;
    squares += weight * weight;
    sum.contact.position_mm += weight * taxels.positions[t];
    sum.contact.normal += weight * taxels.normals[t];
  }
  const double newton = options.taxel_area_mm2 / kKpaMm2PerN;
  sum.contact.position_mm /= kpa;
  sum.contact.normal = sum.contact.normal.stableNormalized();
  sum.contact.force_n = kpa * newton;
  sum.contact.force_sd_n = std::hypot(kSumErrorShare * sum.contact.force_n,
                                      options.noise_kpa * newton * std::sqrt(static_cast<double>(group.size())));
  sum.contact.area_mm2 = options.taxel_area_mm2 * static_cast<double>(group.size());
  // A single taxel locates the centroid within half a pitch; more taxels share the weight and reduce the error.
  sum.contact.position_sd_mm = std::sqrt(options.taxel_area_mm2 / 12.0 * squares) / kpa;
  sum.taxels = group;
  return sum;
}

// Assigns each taxel of a group to the contact that moves it most and drops contacts that get no taxel.
std::vector<PressureContact> with_taxels(const Footprint& footprint, const SurfaceTaxels& taxels,
                                         const SurfaceLayout& layout, const TaxelGroup& group, const Fits& fits) {
  std::vector<PressureContact> contacts;
  std::vector<Eigen::VectorXd> shares;
  for (const FootprintFit& fit : fits) {
    contacts.push_back({on_cover(taxels, layout, estimate_of(fit)), {}});
    shares.push_back(predicted_kpa(footprint, layout.places_mm, fit));
  }
  for (const std::size_t t : group) {
    const auto row = std::find(layout.taxels.begin(), layout.taxels.end(), t) - layout.taxels.begin();
    const auto most =
        std::max_element(shares.begin(), shares.end(), [&](const auto& a, const auto& b) { return a[row] < b[row]; });
    contacts[static_cast<std::size_t>(most - shares.begin())].taxels.push_back(t);
  }
  std::erase_if(contacts, [](const PressureContact& c) { return c.taxels.empty(); });
  for (PressureContact& c : contacts) c.contact.pressed_taxels = static_cast<int>(c.taxels.size());
  return contacts;
}

}  // namespace

std::vector<PressureContact> contacts_from_pressure(const Footprint& footprint,
                                                    std::span<const Eigen::Vector3d> positions_mm,
                                                    std::span<const Eigen::Vector3d> normals,
                                                    std::span<const double> kpa, std::span<const std::size_t> pressed,
                                                    const PressureOptions& options) {
  const SurfaceTaxels cover{positions_mm, normals, kpa};
  check(cover);
  check(options, kpa.size(), pressed);
  TaxelGroup finite(pressed.begin(), pressed.end());
  std::erase_if(finite, [&](std::size_t t) { return !(std::isfinite(kpa[t]) && kpa[t] > 0.0); });
  std::vector<PressureContact> contacts;
  for (const TaxelGroup& group : pressed_groups(cover, std::move(finite), options.max_link_mm)) {
    TaxelGroup strongest = group;
    std::stable_sort(strongest.begin(), strongest.end(), [&](std::size_t a, std::size_t b) { return kpa[a] > kpa[b]; });
    Fits fits;
    const SurfaceLayout layout = laid_out(cover, group);
    if (group.size() <= kMaxFittedTaxels) fits = GroupFit(footprint, layout, options).run(group.size());
    if (fits.empty()) {
      contacts.push_back(summed(cover, strongest, options));
      continue;
    }
    for (PressureContact& c : with_taxels(footprint, cover, layout, strongest, fits)) contacts.push_back(std::move(c));
  }
  std::stable_sort(contacts.begin(), contacts.end(), [](const PressureContact& a, const PressureContact& b) {
    return a.contact.force_n > b.contact.force_n;
  });
  return contacts;
}

}  // namespace triskin::mechanics
