// SPDX-License-Identifier: GPL-3.0-or-later
#include "inverse_study.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "device/mechanics/src/contact_chain.hpp"
#include "triskin/base/dice.hpp"
#include "triskin/base/error.hpp"
#include "triskin/mechanics/inverse.hpp"

namespace triskin::mechanics {
namespace {

constexpr double kStudyThickness_mm = 2.0, kStudyModulus_kpa = 30.0;
constexpr double kMinTip_mm = 4.0, kMaxTip_mm = 40.0, kMinDepthShare = 0.15, kMaxDepthShare = 0.5;
constexpr double kMinSignal = 10.0;
// Superposition holds if the edges are at least 0.7 thicknesses apart.
constexpr double kEdgeGap_mm = 1.4, kMaxDistance_mm = 30.0;
constexpr double kBoundPosition_mm = 0.5, kBoundForce = 0.05;
constexpr double kQuantile = 1.96;

using Positions = std::vector<Eigen::Vector2d>;
using Contacts = std::vector<ContactEstimate>;

// Lays out the taxels of a module of 30 mm in rows of 4, 3, 2 and 1, and those of the module beside it, rotated by half
// a turn.
Positions module_pairs() {
  constexpr double kPitch = 6.533, kRow = 5.66, kBase = 3.0;
  const double height = 30.0 * std::sqrt(0.75);
  Positions taxels;
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector2d corner(30.0 * i + 15.0 * j, height * j), opposite = corner + Eigen::Vector2d(45.0, height);
      for (int row = 0; row < 4; ++row) {
        for (int k = 0; k < 4 - row; ++k) {
          const Eigen::Vector2d taxel(15.0 + kPitch * (k - (3 - row) / 2.0), kBase + kRow * row);
          taxels.emplace_back(corner + taxel);
          taxels.emplace_back(opposite - taxel);
        }
      }
    }
  }
  return taxels;
}

double uniform(Dice& dice, double low, double high) {
  return low + (high - low) * dice.unit();
}

double signal(const std::vector<double>& values, double noise) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum) / noise;
}

struct Draw {
  const ContactTable* table = nullptr;
  Contacts truth;
  std::vector<double> exact;
};

// Returns bounds of x, y and force of each contact from Fisher's information, by differences of the forward model.
std::vector<Eigen::Vector3d> cramer_rao(const Draw& draw, const Positions& taxels, double noise) {
  const auto n = static_cast<Eigen::Index>(4 * draw.truth.size());
  Eigen::MatrixXd slopes(static_cast<Eigen::Index>(taxels.size()), n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto moved = [&](double step) {
      Contacts contacts = draw.truth;
      ContactEstimate& c = contacts[static_cast<std::size_t>(k / 4)];
      if (k % 4 < 2) c.position_mm[k % 4] += step;
      if (k % 4 == 2) c.force_n *= 1.0 + step;
      if (k % 4 == 3) c.tip_radius_mm *= 1.0 + step;
      const auto values = predict_taxels(*draw.table, taxels, contacts);
      return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values.data(), slopes.rows()));
    };
    slopes.col(k) = (moved(2e-3) - moved(-2e-3)) / 4e-3;
  }
  const Eigen::MatrixXd covariance = (slopes.transpose() * slopes).inverse() * noise * noise;
  std::vector<Eigen::Vector3d> bounds;
  for (std::size_t c = 0; c < draw.truth.size(); ++c) {
    const Eigen::Vector3d variances = covariance.diagonal().segment<3>(static_cast<Eigen::Index>(4 * c));
    bounds.push_back(variances.cwiseSqrt().cwiseProduct(Eigen::Vector3d(1.0, 1.0, draw.truth[c].force_n)));
  }
  return bounds;
}

class Study {
 public:
  explicit Study(std::uint64_t seed) : dice_(seed), taxels_(module_pairs()) {
    for (const double poisson : {0.1, 0.3, 0.45})
      tables_.push_back(std::make_unique<ContactTable>(Layer{kStudyThickness_mm, poisson, kStudyModulus_kpa}));
  }
  StudyRow run(int contacts, int draws, double noise) {
    row_ = {};
    row_.contacts = contacts;
    row_.draws = draws;
    noise_ = noise;
    for (int k = 0; k < draws; ++k) look_at(drawn(contacts), k % 10 == 0);
    row_.covered /= std::max(1, 3 * row_.estimates);
    row_.mean_square /= std::max(1, 3 * row_.estimates);
    row_.position_over_bound = std::sqrt(row_.position_over_bound / std::max(1, row_.bounded));
    row_.force_over_bound = std::sqrt(row_.force_over_bound / std::max(1, row_.bounded));
    return row_;
  }

 private:
  // Draws one contact somewhere between the taxels; returns nothing if the table or the layer does not allow it.
  std::optional<ContactEstimate> drawn_contact(const ContactTable& table) {
    ContactEstimate c;
    c.position_mm = {uniform(dice_, 12.0, 93.0), uniform(dice_, 3.0, 48.0)};
    c.tip_radius_mm = kMinTip_mm * std::pow(kMaxTip_mm / kMinTip_mm, dice_.unit());
    const double depth_mm = kStudyThickness_mm * uniform(dice_, kMinDepthShare, kMaxDepthShare);
    const Contact pressed =
        table.press_to_radius({Shape::kSphere, c.tip_radius_mm}, std::sqrt(1.7 * c.tip_radius_mm * depth_mm));
    c.force_n = pressed.force;
    c.contact_radius_mm = pressed.contact_radius_mm;
    const Contacts alone = {c};
    if (signal(predict_taxels(table, taxels_, alone), noise_) < kMinSignal) return std::nullopt;
    return c;
  }
  Draw drawn(int contacts) {
    while (true) {
      Draw draw{tables_[static_cast<std::size_t>(dice_.below(3))].get(), {}, {}};
      try {
        while (static_cast<int>(draw.truth.size()) < contacts) {
          if (auto c = drawn_contact(*draw.table); c && stands_apart(*c, draw.truth)) draw.truth.push_back(*c);
        }
        draw.exact = predict_taxels(*draw.table, taxels_, draw.truth);
        return draw;
      } catch (const InputError&) {
        continue;  // The tip would reach the base.
      }
    }
  }
  static bool stands_apart(const ContactEstimate& c, const Contacts& others) {
    return std::all_of(others.begin(), others.end(), [&](const ContactEstimate& o) {
      const double distance = (c.position_mm - o.position_mm).norm();
      return distance > c.contact_radius_mm + o.contact_radius_mm + kEdgeGap_mm && distance < kMaxDistance_mm;
    });
  }
  [[nodiscard]] Contacts solved(const Draw& draw, bool with_noise) {
    std::vector<TaxelObservation> observations;
    for (std::size_t t = 0; t < taxels_.size(); ++t)
      observations.push_back({taxels_[t], draw.exact[t] + (with_noise ? noise_ * standard_normal(dice_) : 0.0)});
    InverseOptions options;
    if (with_noise) options.noise_dc_over_c = noise_;
    return find_contacts(*draw.table, observations, options).contacts;
  }
  // Returns the estimates in the order of the truth.
  static Contacts in_order(Contacts found, const Contacts& truth) {
    if (truth.size() == 2 &&
        (found[0].position_mm - truth[0].position_mm).norm() + (found[1].position_mm - truth[1].position_mm).norm() >
            (found[1].position_mm - truth[0].position_mm).norm() + (found[0].position_mm - truth[1].position_mm).norm())
      std::swap(found[0], found[1]);
    return found;
  }
  static bool is_bounded(const Eigen::Vector3d& bound, const ContactEstimate& truth) {
    return bound.head<2>().norm() <= kBoundPosition_mm && bound[2] <= kBoundForce * truth.force_n;
  }
  void look_at(const Draw& draw, bool also_exact) {
    const auto bounds = cramer_rao(draw, taxels_, noise_);
    const Contacts noisy = solved(draw, true);
    if (noisy.size() == draw.truth.size()) {
      const Contacts found = in_order(noisy, draw.truth);
      for (std::size_t c = 0; c < found.size(); ++c)
        add_noisy(found[c], draw.truth[c], bounds[c], is_bounded(bounds[c], draw.truth[c]));
    } else {
      ++row_.wrong_counts;
    }
    if (!also_exact) return;
    const Contacts exact = solved(draw, false);
    for (std::size_t c = 0; c < draw.truth.size(); ++c) {
      if (!is_bounded(bounds[c], draw.truth[c])) continue;
      ++row_.exact;
      add_exact(exact, draw.truth[c]);
    }
  }
  void add_noisy(const ContactEstimate& found, const ContactEstimate& truth, const Eigen::Vector3d& bound,
                 bool is_bounded) {
    const Eigen::Vector2d offset = found.position_mm - truth.position_mm;
    const Eigen::Array3d error(offset.x(), offset.y(), found.force_n - truth.force_n);
    const Eigen::Array3d deviation(found.position_sd_mm.x(), found.position_sd_mm.y(), found.force_sd_n);
    const Eigen::Array3d whitened = error / deviation;
    ++row_.estimates;
    row_.covered += static_cast<double>((whitened.abs() < kQuantile).count());
    row_.mean_square += whitened.square().sum();
    if (!is_bounded) return;
    ++row_.bounded;
    row_.position_over_bound += offset.squaredNorm() / bound.head<2>().squaredNorm();
    row_.force_over_bound += error[2] * error[2] / (bound[2] * bound[2]);
  }
  void add_exact(const Contacts& found, const ContactEstimate& truth) {
    double position = kMaxDistance_mm, force = 1.0;
    for (const ContactEstimate& c : found) {
      const double distance = (c.position_mm - truth.position_mm).norm();
      if (distance >= position) continue;
      position = distance;
      force = std::abs(c.force_n / truth.force_n - 1.0);
    }
    row_.exact_position_mm = std::max(row_.exact_position_mm, position);
    row_.exact_force_share = std::max(row_.exact_force_share, force);
  }

  Dice dice_;
  Positions taxels_;
  std::vector<std::unique_ptr<ContactTable>> tables_;
  double noise_ = 0.01;
  StudyRow row_;
};

}  // namespace

InverseStudy study_inverse(int draws, std::uint64_t seed) {
  if (draws < 10 || draws > 100000) throw InputError(fmt::format("inverse: {} draws; give 10 … 100000", draws));
  InverseStudy result;
  result.seed = seed;
  Study study(seed);
  result.rows.push_back(study.run(1, draws - draws / 2, result.noise_dc_over_c));
  result.rows.push_back(study.run(2, draws / 2, result.noise_dc_over_c));
  return result;
}

std::string study_text(const InverseStudy& study) {
  std::string text = fmt::format(
      "Noise {} in ΔC/C, seed {}.\n\n"
      "| contacts | draws | wrong count | within 1.96 deviations | mean square of error / deviation | bounded contacts "
      "| "
      "position error / bound | force error / bound | without noise: worst position, mm | worst force |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n",
      study.noise_dc_over_c, study.seed);
  for (const StudyRow& r : study.rows) {
    text += fmt::format(
        "| {} | {} | {} | {:.1f} % | {:.2f} | {} of {} | {:.2f} | {:.2f} | {:.3f} | {:.2f} % ({} contacts) |\n",
        r.contacts, r.draws, r.wrong_counts, 100.0 * r.covered, r.mean_square, r.bounded, r.estimates,
        r.position_over_bound, r.force_over_bound, r.exact_position_mm, 100.0 * r.exact_force_share, r.exact);
  }
  return text;
}

}  // namespace triskin::mechanics
