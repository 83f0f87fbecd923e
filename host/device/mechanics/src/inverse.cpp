// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mechanics/inverse.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "contact_search.hpp"
#include "taxel_model.hpp"
#include "triskin/base/error.hpp"

namespace triskin::mechanics {
namespace {

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
  return search_contacts(model, observed, options, Effort::kFull);
}

std::vector<double> predict_taxels(const ContactTable& table, std::span<const Eigen::Vector2d> taxel_positions_mm,
                                   std::span<const ContactEstimate> contacts, double disc_diameter_mm) {
  std::vector<FitContact> all;
  for (const ContactEstimate& c : contacts) {
    // This throws with the reason if a contact is impossible by itself.
    (void)table.press({Shape::kSphere, c.tip_radius_mm}, c.force_n);
    all.push_back({c.position_mm, std::log(c.force_n), std::log(c.tip_radius_mm)});
  }
  const TaxelModel model(table, {taxel_positions_mm.begin(), taxel_positions_mm.end()}, disc_diameter_mm / 2.0);
  const auto response = model.respond(all, false);
  if (!response) throw InputError("contact: the displacements of the contacts add up to the thickness of the layer");
  return {response->values.begin(), response->values.end()};
}

}  // namespace triskin::mechanics
