// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "triskin/mechanics/inverse.hpp"

namespace triskin::mechanics {

/// One observation of a file with its known conditions.
struct InverseCase {
  nlohmann::json id;
  Layer layer;
  std::vector<TaxelObservation> taxels;
  InverseOptions options;
};

/// Reads observations: an object with `modules`, each with `taxels_mm` (a list of [x, y]), optionally
/// `taxel_disc_diameter_mm` (4), and `cases`. A case has `material` {h_mm, nu, E_kpa} and `dC_over_C0`, a list of
/// values for each module, null for a taxel without a value; optionally `id`, `temperature_pads` (indices that feel no
/// pressure; 6 and 10), `contacts` (how many), `noise_dC_over_C0` and `R_mm` (radius of the tips). The noise may stand
/// beside `cases`, too. Throws InputError with the file, the place and what is expected.
[[nodiscard]] std::vector<InverseCase> read_inverse_cases(const std::filesystem::path& path);

/// Returns the contacts of each case, as find_contacts(); cases of one Poisson's ratio share a table. Throws InputError
/// as find_contacts() does.
[[nodiscard]] std::vector<InverseResult> solve_inverse_cases(const std::vector<InverseCase>& cases);

}  // namespace triskin::mechanics
