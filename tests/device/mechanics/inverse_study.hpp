// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace triskin::mechanics {

/// Summarizes the results of find_contacts() on contacts whose truth is known, for one number of contacts.
struct StudyRow {
  int contacts = 0;  ///< Each draw presses this many contacts.
  int draws = 0;
  int wrong_counts = 0;      ///< In these draws another number of contacts was found.
  int estimates = 0;         ///< Contacts of the other draws count here; each has x, y and force.
  double covered = 0.0;      ///< This fraction of the three values lies within 1.96 stated deviations of the truth.
  double mean_square = 0.0;  ///< The mean square of error over stated deviation is 1 if the stated deviations are true.
  /// The Cramér-Rao bound allows these contacts to be known to 0.5 mm and 5 %; the root mean square is of error over
  /// bound.
  int bounded = 0;
  double position_over_bound = 0.0, force_over_bound = 0.0;
  /// These draws had no noise, and the errors are the worst ones.
  int exact = 0;
  double exact_position_mm = 0.0, exact_force_share = 0.0;
};

struct InverseStudy {
  std::uint64_t seed = 0;
  double noise_dc_over_c = 0.01;
  std::vector<StudyRow> rows;  ///< The rows have one and two contacts.
};

/// Draws `draws` observations of twelve modules (120 taxels), half of one contact and half of two: tips of 4 … 40 mm,
/// indentations of 0.15 … 0.5 of a layer of 2 mm, Poisson's ratio 0.1, 0.3 or 0.45, anywhere between the taxels;
/// noise of 0.01 in ΔC/C, stated. A contact that moves the taxels by less than ten deviations in all is drawn anew.
/// Each tenth observation is also solved without noise. Throws InputError unless 10 ≤ draws ≤ 100000. Cost: some
/// 0.4 s per draw.
[[nodiscard]] InverseStudy study_inverse(int draws, std::uint64_t seed);

/// Writes the study as Markdown.
[[nodiscard]] std::string study_text(const InverseStudy& study);

}  // namespace triskin::mechanics
