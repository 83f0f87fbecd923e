// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "contact_count.hpp"
#include "contact_fit.hpp"
#include "contact_guess.hpp"
#include "contact_posterior.hpp"
#include "contact_ridge.hpp"

namespace triskin::mechanics {
namespace {

// The superposition is exact to about this fraction of the peak; smaller residuals do not require another contact.
constexpr double kModelErrorShare = 1e-3;
// The table is exact to about this fraction, so no fit is trusted further.
constexpr double kTableErrorShare = 5e-5;
// If no noise is stated, the first fits assume this fraction of the peak.
constexpr double kFirstNoiseShare = 0.01;
// A taxel counts as pressed above this fraction of the peak and so many deviations of a stated noise.
constexpr double kSignalShare = 0.02, kSignalDeviations = 3.5;
constexpr double kKnownRadiusSd = 1e-3;
// Each start gets this many steps; only the best fits then continue to their minimum.
constexpr int kFirstSteps = 8;
constexpr std::size_t kFinalists = 4;
// Starts that have come this close to each other lead to the same minimum.
constexpr double kSameMinimum_mm = 0.5;
// If one more contact gains less than this fraction of what it should, no further one is tried, because that would have
// to gain the rest.
constexpr double kHopelessShare = 0.5;
constexpr double kGoodDeviations = 2.0;

using Starts = std::vector<std::vector<FitContact>>;

std::vector<FitContact> with_radius(const std::vector<ForceGuess>& guesses, double radius_mm) {
  std::vector<FitContact> contacts;
  for (const ForceGuess& g : guesses) contacts.push_back({g.position_mm, std::log(g.force_n), std::log(radius_mm)});
  return contacts;
}

// Merges the nearest two until `count` remain.
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

bool is_same_minimum(const Fit& a, const Fit& b) {
  for (std::size_t c = 0; c < a.contacts.size(); ++c) {
    if ((a.contacts[c].position_mm - b.contacts[c].position_mm).norm() > kSameMinimum_mm) return false;
  }
  return true;
}

// Returns the most promising fits, each on its way to another minimum.
std::vector<Fit> finalists(std::vector<Fit> fits) {
  std::sort(fits.begin(), fits.end(), [](const Fit& a, const Fit& b) { return a.objective < b.objective; });
  std::vector<Fit> chosen;
  for (Fit& fit : fits) {
    if (chosen.size() == kFinalists) break;
    if (std::none_of(chosen.begin(), chosen.end(), [&](const Fit& other) { return is_same_minimum(fit, other); }))
      chosen.push_back(std::move(fit));
  }
  return chosen;
}

class ContactSearch {
 public:
  ContactSearch(const TaxelModel& model, const Eigen::VectorXd& observed, const InverseOptions& options, Effort effort)
      : model_(model),
        observed_(observed),
        options_(options),
        effort_(effort),
        priors_(priors_for(model.table().layer())) {
    peak_ = observed_.size() == 0 ? 0.0 : std::max(0.0, observed_.maxCoeff());
    noise_ = std::max(options.noise_dc_over_c.value_or(kFirstNoiseShare * peak_), kTableErrorShare * peak_);
    if (options.tip_radius_mm) {
      priors_.log_radius = std::log(*options.tip_radius_mm);
      priors_.log_radius_sd = kKnownRadiusSd;
    }
    const double floor = std::max(kSignalShare * peak_, kSignalDeviations * options.noise_dc_over_c.value_or(0.0));
    is_pressed_ = peak_ > floor;
    if (is_pressed_ && effort_ == Effort::kFull) guesses_ = guess_contacts(model, observed_, floor);
  }
  InverseResult run();

 private:
  [[nodiscard]] FitProblem problem(double noise) const { return {model_, observed_, noise, priors_}; }
  [[nodiscard]] bool explains_all(const Fit& fit) const;
  [[nodiscard]] double gain_share(const Fit& more, const Fit& fewer) const;
  [[nodiscard]] Starts starts(std::size_t count, const Fit& fewer) const;
  [[nodiscard]] Starts added(const Fit& fewer) const;
  [[nodiscard]] std::vector<double> radii(std::size_t count) const;
  [[nodiscard]] std::optional<Fit> first_fit(std::vector<FitContact> start) const;
  [[nodiscard]] std::optional<Fit> best_fit(const Starts& starts) const;
  [[nodiscard]] Fit search() const;
  [[nodiscard]] Fit with_found_noise(Fit fit) const;
  [[nodiscard]] InverseResult report(Fit fit) const;
  [[nodiscard]] double found_noise(const Fit& fit) const;

  const TaxelModel& model_;
  const Eigen::VectorXd& observed_;
  const InverseOptions& options_;
  Effort effort_;
  FitPriors priors_;
  double peak_ = 0.0, noise_ = 0.0;
  bool is_pressed_ = false;
  std::vector<ForceGuess> guesses_;
};

// Returns true if the remainder looks like the stated noise: its sum of squares has a mean of n and a deviation of
// √2n.
bool ContactSearch::explains_all(const Fit& fit) const {
  if (!options_.noise_dc_over_c) return false;
  const auto n = static_cast<double>(observed_.size());
  const double floor = kModelErrorShare * peak_;
  const double variance = *options_.noise_dc_over_c * *options_.noise_dc_over_c + floor * floor;
  return fit.residual_sum < variance * (n + kGoodDeviations * std::sqrt(2.0 * n));
}

// Returns the gain of the likelihood ratio over the required gain for that many more contacts; above 1 they count. The
// error of the model is added to the noise, so that exact data does not require ever more contacts. If the noise is not
// stated, the logarithm of the ratio replaces the gain, with Bartlett's factor for the parameters that the fit spends.
double ContactSearch::gain_share(const Fit& more, const Fit& fewer) const {
  const auto n = static_cast<double>(observed_.size());
  const auto further = static_cast<double>(more.contacts.size() - fewer.contacts.size());
  const double wanted = further * count_threshold(n), floor = kModelErrorShare * peak_;
  if (options_.noise_dc_over_c) {
    const double variance = *options_.noise_dc_over_c * *options_.noise_dc_over_c + floor * floor;
    return (fewer.residual_sum - more.residual_sum) / (wanted * variance);
  }
  const double spent = kParametersPerContact * (static_cast<double>(more.contacts.size()) - further / 2.0) + 1.0;
  const double ratio = (fewer.residual_sum + n * floor * floor) / (more.residual_sum + n * floor * floor);
  return std::max(1.0, n - spent) * std::log(ratio) / wanted;
}

std::vector<double> ContactSearch::radii(std::size_t count) const {
  if (options_.tip_radius_mm) return {*options_.tip_radius_mm};
  if (effort_ == Effort::kStream) return {12.0};
  return count == 1 ? std::vector<double>{5.0, 14.0, 40.0} : std::vector<double>{8.0, 25.0};
}

// Adds one more contact where the fewer leave most unexplained, and splits the strongest in two directions.
Starts ContactSearch::added(const Fit& fewer) const {
  Starts starts;
  const auto response = model_.respond(fewer.contacts, false);
  if (!response || fewer.contacts.empty()) return starts;
  for (const ForceGuess& guess : guess_peak(model_, observed_ - response->values)) {
    starts.push_back(fewer.contacts);
    starts.back().push_back({guess.position_mm, std::log(guess.force_n), priors_.log_radius});
  }
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

Starts ContactSearch::starts(std::size_t count, const Fit& fewer) const {
  Starts starts = added(fewer);
  for (const double r : radii(count)) {
    if (guesses_.size() >= count) {
      const std::vector<ForceGuess> best(guesses_.begin(), guesses_.begin() + static_cast<std::ptrdiff_t>(count));
      starts.push_back(with_radius(best, r));
      if (count < guesses_.size()) starts.push_back(with_radius(merged(guesses_, count), r));
    }
    if (count > 1) continue;
    for (const ForceGuess& guess : guess_peak(model_, observed_)) starts.push_back(with_radius({guess}, r));
  }
  return starts;
}

// A guessed force may push a small tip through the layer; a blunter one stays inside.
std::optional<Fit> ContactSearch::first_fit(std::vector<FitContact> start) const {
  for (int attempt = 0; attempt < 6; ++attempt) {
    if (auto fit = fit_contacts(problem(noise_), start, kFirstSteps)) return fit;
    for (FitContact& c : start)
      (options_.tip_radius_mm ? c.log_force : c.log_radius) += options_.tip_radius_mm ? -0.5 : 0.6;
  }
  return std::nullopt;
}

// All starts make a few steps, and the most promising continue to their minimum.
std::optional<Fit> ContactSearch::best_fit(const Starts& starts) const {
  std::vector<Fit> fits;
  for (const std::vector<FitContact>& start : starts) {
    if (auto fit = first_fit(start)) fits.push_back(*std::move(fit));
  }
  fits = finalists(std::move(fits));
  for (Fit& fit : fits) {
    if (auto further = fit_contacts(problem(noise_), fit.contacts)) fit = *std::move(further);
  }
  // The width of a minimum means something if the noise is known.
  const auto rank = [&](const Fit& fit) { return options_.noise_dc_over_c ? evidence_objective(fit) : fit.objective; };
  const auto best =
      std::min_element(fits.begin(), fits.end(), [&](const Fit& a, const Fit& b) { return rank(a) < rank(b); });
  return best == fits.end() ? std::nullopt : std::optional<Fit>(*best);
}

double ContactSearch::found_noise(const Fit& fit) const {
  if (options_.noise_dc_over_c) return *options_.noise_dc_over_c;
  const double freedom =
      static_cast<double>(observed_.size()) - kParametersPerContact * static_cast<double>(fit.contacts.size());
  return std::sqrt(fit.residual_sum / std::max(1.0, freedom));
}

InverseResult ContactSearch::report(Fit fit) const {
  const std::vector<ContactMoments> moments =
      effort_ == Effort::kFull ? posterior_moments(problem(fit.noise), fit) : ridge_moments(problem(fit.noise), fit);
  InverseResult result;
  result.noise_dc_over_c = found_noise(fit);
  result.residual_dc_over_c =
      std::sqrt(fit.residual_sum / static_cast<double>(std::max<Eigen::Index>(1, observed_.size())));
  for (std::size_t c = 0; c < fit.contacts.size(); ++c) {
    const ContactMoments& m = moments[c];
    const FitContact& k = fit.contacts[c];
    const Contact pressed = model_.table().press({Shape::kSphere, std::exp(k.log_radius)}, std::exp(k.log_force));
    result.contacts.push_back({m.mean.head<2>(), m.deviation.head<2>(), m.mean[2], m.deviation[2], m.mean[3],
                               m.deviation[3], pressed.contact_radius_mm, pressed.indentation_mm});
  }
  std::sort(result.contacts.begin(), result.contacts.end(),
            [](const ContactEstimate& a, const ContactEstimate& b) { return a.force_n > b.force_n; });
  return result;
}

// Adds contacts until none more explains enough, or the requested number is reached.
Fit ContactSearch::search() const {
  Fit best, fewer;
  best.residual_sum = observed_.squaredNorm();
  fewer = best;
  const int most = options_.contacts.value_or(options_.max_contacts);
  for (int count = 1; count <= most; ++count) {
    std::optional<Fit> fit = best_fit(starts(static_cast<std::size_t>(count), fewer));
    if (!fit) break;
    const double share = options_.contacts ? 1.0 : gain_share(*fit, best);
    if (share >= 1.0) best = *fit;
    if (share < kHopelessShare) break;
    if (effort_ == Effort::kStream && explains_all(best)) break;
    fewer = std::move(*fit);
  }
  return best;
}

Fit ContactSearch::with_found_noise(Fit fit) const {
  if (options_.noise_dc_over_c || fit.contacts.empty()) return fit;
  const double noise = std::max(found_noise(fit), kTableErrorShare * peak_);
  auto again = fit_contacts(problem(noise), fit.contacts);
  return again ? *std::move(again) : fit;
}

InverseResult ContactSearch::run() {
  Fit none;
  none.residual_sum = observed_.squaredNorm();
  if (!is_pressed_ || options_.contacts == 0) return report(none);
  return report(with_found_noise(search()));
}

}  // namespace

InverseResult search_contacts(const TaxelModel& model, const Eigen::VectorXd& observed, const InverseOptions& options,
                              Effort effort) {
  return ContactSearch(model, observed, options, effort).run();
}

}  // namespace triskin::mechanics
