// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mechanics/inverse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "contact_fit.hpp"
#include "contact_guess.hpp"
#include "contact_posterior.hpp"
#include "taxel_model.hpp"
#include "triskin/base/error.hpp"

namespace triskin::mechanics {
namespace {

// The table and the superposition are exact to about this share of the peak; smaller residuals say nothing.
constexpr double kModelErrorShare = 1e-3;
// The table is exact to about this share, so no fit is trusted further.
constexpr double kTableErrorShare = 5e-5;
// Beyond these deviations the posterior is no longer normal, and samples take the place of the Gauss-Newton matrix.
constexpr double kWidePosition_mm = 0.3, kWideLogForce = 0.1;
// Noise that is assumed in the first fits where none is stated, as a share of the peak.
constexpr double kFirstNoiseShare = 0.01;
constexpr double kSignalShare = 0.02;
constexpr double kKnownRadiusSd = 1e-3;

using Starts = std::vector<std::vector<FitContact>>;

void check(const InverseOptions& options) {
  const auto positive = [](const std::optional<double>& v) { return !v || (std::isfinite(*v) && *v > 0.0); };
  if (!(options.disc_diameter_mm > 0.0)) throw InputError("inverse: the diameter of the taxels' discs is not positive");
  if (!positive(options.noise_dc_over_c)) throw InputError("inverse: the noise is not a positive number");
  if (!positive(options.tip_radius_mm)) throw InputError("inverse: the tip radius is not a positive number of mm");
  if (options.contacts && (*options.contacts < 0 || *options.contacts > 12))
    throw InputError(fmt::format("inverse: {} contacts; give 0 … 12", *options.contacts));
  if (options.max_contacts < 1 || options.max_contacts > 12)
    throw InputError(fmt::format("inverse: at most {} contacts; give 1 … 12", options.max_contacts));
}

std::vector<FitContact> with_radius(const std::vector<ForceGuess>& guesses, double radius_mm) {
  std::vector<FitContact> contacts;
  for (const ForceGuess& g : guesses) contacts.push_back({g.position_mm, std::log(g.force_n), std::log(radius_mm)});
  return contacts;
}

// The nearest two become one until `count` are left.
std::vector<ForceGuess> merged(std::vector<ForceGuess> guesses, std::size_t count) {
  while (guesses.size() > count) {
    std::size_t a = 0, b = 1;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < guesses.size(); ++i) {
      for (std::size_t j = i + 1; j < guesses.size(); ++j) {
        const double distance = (guesses[i].position_mm - guesses[j].position_mm).norm();
        if (distance >= nearest) continue;
        nearest = distance;
        a = i;
        b = j;
      }
    }
    const double force = guesses[a].force_n + guesses[b].force_n;
    guesses[a].position_mm =
        (guesses[a].force_n * guesses[a].position_mm + guesses[b].force_n * guesses[b].position_mm) / force;
    guesses[a].force_n = force;
    guesses.erase(guesses.begin() + static_cast<std::ptrdiff_t>(b));
  }
  return guesses;
}

class ContactSearch {
 public:
  ContactSearch(const TaxelModel& model, Eigen::VectorXd observed, const InverseOptions& options)
      : model_(model), observed_(std::move(observed)), options_(options) {
    peak_ = observed_.size() == 0 ? 0.0 : std::max(0.0, observed_.maxCoeff());
    noise_ = std::max(options.noise_dc_over_c.value_or(kFirstNoiseShare * peak_), kTableErrorShare * peak_);
    if (options.tip_radius_mm) {
      priors_.log_radius = std::log(*options.tip_radius_mm);
      priors_.log_radius_sd = kKnownRadiusSd;
    }
    if (peak_ > 0.0) guesses_ = guess_contacts(model, observed_, std::max(kSignalShare * peak_, 2.5 * stated_noise()));
  }
  InverseResult run();

 private:
  [[nodiscard]] double stated_noise() const { return options_.noise_dc_over_c.value_or(0.0); }
  [[nodiscard]] double criterion(double residual_sum, int contacts) const;
  [[nodiscard]] Starts starts(std::size_t count, const Fit* fewer) const;
  [[nodiscard]] Starts added(const Fit& fewer) const;
  [[nodiscard]] std::vector<double> radii(std::size_t count) const;
  [[nodiscard]] std::optional<Fit> best_fit(const Starts& starts, double noise) const;
  [[nodiscard]] ContactMoments moments(const Fit& fit, std::size_t contact) const;
  [[nodiscard]] InverseResult report(const Fit& fit) const;
  [[nodiscard]] double found_noise(const Fit& fit) const;

  const TaxelModel& model_;
  Eigen::VectorXd observed_;
  const InverseOptions& options_;
  FitPriors priors_;
  double peak_ = 0.0, noise_ = 0.0;
  std::vector<ForceGuess> guesses_;
};

// Extended Bayesian information criterion (Chen and Chen, Biometrika 95 (2008) 759): a new contact may appear at any
// taxel, which costs 2 ln n beside its parameters. The error of the model stands beside the noise, so that exact data
// does not call for more and more contacts.
double ContactSearch::criterion(double residual_sum, int contacts) const {
  const auto n = static_cast<double>(observed_.size());
  const double floor = kModelErrorShare * peak_;
  const double penalty = (kParametersPerContact + 2) * contacts * std::log(n);
  if (options_.noise_dc_over_c) return residual_sum / (stated_noise() * stated_noise() + floor * floor) + penalty;
  return n * std::log(residual_sum / n + floor * floor) + penalty;
}

std::vector<double> ContactSearch::radii(std::size_t count) const {
  if (options_.tip_radius_mm) return {*options_.tip_radius_mm};
  return count == 1 ? std::vector<double>{5.0, 14.0, 40.0} : std::vector<double>{8.0, 25.0};
}

// One more contact where the fewer leave most unexplained, and the strongest split in two directions.
Starts ContactSearch::added(const Fit& fewer) const {
  Starts starts;
  const auto response = model_.respond(fewer.contacts, false);
  Eigen::Index worst = 0;
  if (!response || fewer.contacts.empty()) return starts;
  (observed_ - response->values).maxCoeff(&worst);
  double radius = priors_.log_radius;
  std::vector<FitContact> more = fewer.contacts;
  more.push_back({model_.positions_mm()[static_cast<std::size_t>(worst)], fewer.contacts[0].log_force - 1.5, radius});
  starts.push_back(more);
  const auto strongest = std::max_element(fewer.contacts.begin(), fewer.contacts.end(),
                                          [](const auto& a, const auto& b) { return a.log_force < b.log_force; });
  for (const Eigen::Vector2d& offset : {Eigen::Vector2d(3.5, 0.0), Eigen::Vector2d(0.0, 3.5)}) {
    std::vector<FitContact> split = fewer.contacts;
    FitContact& half = split[static_cast<std::size_t>(strongest - fewer.contacts.begin())];
    half.log_force -= std::log(2.0);
    FitContact other = half;
    half.position_mm += offset;
    other.position_mm -= offset;
    split.push_back(other);
    starts.push_back(std::move(split));
  }
  return starts;
}

Starts ContactSearch::starts(std::size_t count, const Fit* fewer) const {
  Starts starts;
  if (guesses_.size() >= count) {
    const std::vector<ForceGuess> strongest(guesses_.begin(), guesses_.begin() + static_cast<std::ptrdiff_t>(count));
    for (const double r : radii(count)) {
      starts.push_back(with_radius(merged(guesses_, count), r));
      if (count < guesses_.size()) starts.push_back(with_radius(strongest, r));
    }
  }
  if (fewer != nullptr) {
    for (auto& start : added(*fewer)) starts.push_back(std::move(start));
  }
  return starts;
}

std::optional<Fit> ContactSearch::best_fit(const Starts& starts, double noise) const {
  std::optional<Fit> best;
  for (std::vector<FitContact> start : starts) {
    std::optional<Fit> fit;
    // A guess of the force may push a small tip through the layer: a blunter one holds it.
    for (int attempt = 0; attempt < 6 && !fit; ++attempt) {
      fit = fit_contacts(model_, observed_, start, start, noise, priors_);
      for (FitContact& c : start)
        (options_.tip_radius_mm ? c.log_force : c.log_radius) += options_.tip_radius_mm ? -0.5 : 0.6;
    }
    if (fit && (!best || fit->objective < best->objective)) best = std::move(fit);
  }
  return best;
}

double ContactSearch::found_noise(const Fit& fit) const {
  if (options_.noise_dc_over_c) return *options_.noise_dc_over_c;
  const double freedom =
      static_cast<double>(observed_.size()) - kParametersPerContact * static_cast<double>(fit.contacts.size());
  return std::sqrt(fit.residual_sum / std::max(1.0, freedom));
}

ContactMoments ContactSearch::moments(const Fit& fit, std::size_t contact) const {
  const FitContact& k = fit.contacts[contact];
  const auto block = static_cast<Eigen::Index>(kParametersPerContact * contact);
  const Eigen::Vector4d sd = fit.covariance.diagonal().segment<4>(block).cwiseSqrt();
  if (sd.head<2>().maxCoeff() > kWidePosition_mm || sd[2] > kWideLogForce) {
    if (const auto sampled = sample_posterior(model_, observed_, fit, contact, priors_)) return *sampled;
  }
  const double force = std::exp(k.log_force), radius = std::exp(k.log_radius);
  return {{k.position_mm.x(), k.position_mm.y(), force, radius}, {sd[0], sd[1], force * sd[2], radius * sd[3]}};
}

InverseResult ContactSearch::report(const Fit& fit) const {
  InverseResult result;
  result.noise_dc_over_c = found_noise(fit);
  result.residual_dc_over_c =
      std::sqrt(fit.residual_sum / static_cast<double>(std::max<Eigen::Index>(1, observed_.size())));
  for (std::size_t c = 0; c < fit.contacts.size(); ++c) {
    const ContactMoments m = moments(fit, c);
    const FitContact& k = fit.contacts[c];
    const Contact pressed = model_.table().press({Shape::kSphere, std::exp(k.log_radius)}, std::exp(k.log_force));
    result.contacts.push_back({m.mean.head<2>(), m.deviation.head<2>(), m.mean[2], m.deviation[2], m.mean[3],
                               m.deviation[3], pressed.contact_radius_mm, pressed.indentation_mm});
  }
  std::sort(result.contacts.begin(), result.contacts.end(),
            [](const ContactEstimate& a, const ContactEstimate& b) { return a.force_n > b.force_n; });
  return result;
}

InverseResult ContactSearch::run() {
  Fit best;
  best.residual_sum = observed_.squaredNorm();
  if (guesses_.empty() || options_.contacts == 0) return report(best);
  double best_criterion = criterion(best.residual_sum, 0);
  std::optional<Fit> fewer;
  const int most = options_.contacts.value_or(options_.max_contacts);
  int failures = 0;
  for (int count = 1; count <= most && failures < 2; ++count) {
    std::optional<Fit> fit = best_fit(starts(static_cast<std::size_t>(count), fewer ? &*fewer : nullptr), noise_);
    if (!fit) continue;
    const double value = criterion(fit->residual_sum, count);
    const bool is_wanted = options_.contacts ? count == most : value < best_criterion;
    if (is_wanted) {
      best = *fit;
      best_criterion = value;
    }
    failures = is_wanted || options_.contacts ? 0 : failures + 1;
    fewer = std::move(fit);
  }
  if (best.contacts.empty() && options_.contacts && fewer) best = *fewer;
  if (!options_.noise_dc_over_c && !best.contacts.empty()) {
    const double noise = std::max(found_noise(best), kTableErrorShare * peak_);
    if (auto again = fit_contacts(model_, observed_, best.contacts, best.prior_centres, noise, priors_)) best = *again;
  }
  return report(best);
}

}  // namespace

InverseResult find_contacts(const ContactTable& table, std::span<const TaxelObservation> observations,
                            const InverseOptions& options) {
  check(options);
  std::vector<Eigen::Vector2d> positions;
  std::vector<double> values;
  for (const TaxelObservation& o : observations) {
    if (!std::isfinite(o.dc_over_c) || !o.position_mm.allFinite()) continue;
    positions.push_back(o.position_mm);
    values.push_back(o.dc_over_c);
  }
  const Eigen::VectorXd observed =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  const TaxelModel model(table, std::move(positions), options.disc_diameter_mm / 2.0);
  return ContactSearch(model, observed, options).run();
}

std::vector<double> predict_taxels(const ContactTable& table, std::span<const Eigen::Vector2d> taxel_positions_mm,
                                   std::span<const ContactEstimate> contacts, double disc_diameter_mm) {
  std::vector<FitContact> all;
  for (const ContactEstimate& c : contacts) {
    // Throws with the reason where a contact is impossible by itself.
    (void)table.press({Shape::kSphere, c.tip_radius_mm}, c.force_n);
    all.push_back({c.position_mm, std::log(c.force_n), std::log(c.tip_radius_mm)});
  }
  const TaxelModel model(table, {taxel_positions_mm.begin(), taxel_positions_mm.end()}, disc_diameter_mm / 2.0);
  const auto response = model.respond(all, false);
  if (!response) throw InputError("contact: the displacements of the contacts add up to the thickness of the layer");
  return {response->values.begin(), response->values.end()};
}

}  // namespace triskin::mechanics
