// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the levels of the contact model against the exact layer, and contacts found from noisy taxels against their
// truth.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <tuple>

#include "bench.hpp"
#include "device/mechanics/inverse_study.hpp"
#include "device/mechanics/src/bonded_layer.hpp"
#include "device/mechanics/src/layer_patch.hpp"
#include "device/mechanics/src/logarithmic.hpp"
#include "device/mechanics/src/winkler.hpp"
#include "triskin/base/dice.hpp"
#include "triskin/base/error.hpp"
#include "triskin/mechanics/contact_table.hpp"
#include "triskin/mechanics/inverse.hpp"
#include "triskin/mechanics/taxel.hpp"

namespace triskin::mechanics {
namespace {

/// Gives the worst relative errors of one level against the exact solution. The error of a taxel is relative to the
/// peak of ΔC/C.
struct LevelErrors {
  double indentation = 0.0, contact_radius = 0.0, peak_pressure = 0.0, taxel = 0.0;
  int refused = 0;  ///< The exact solution has an answer for these contacts, but this level has none.
};

/// Gives the errors of the levels winkler, log and table for contacts of one Poisson's ratio and one range of contact
/// radii.
struct ComparisonRow {
  std::string indenter;
  double poisson = 0.0;
  double min_ratio = 0.0, max_ratio = 0.0;  ///< The contact radii are in thicknesses of the layer.
  int contacts = 0;
  std::array<LevelErrors, 3> levels;
};

/// Gives the median cost of one contact by a level, in microseconds.
struct LevelCost {
  std::string level;
  double microseconds = 0.0;
};

/// Compares the grid of layer_patch.hpp with the exact solution of a sphere.
struct PatchRow {
  double poisson = 0.0, points_per_radius = 0.0;
  int points = 0;  ///< The patch has this many points per side.
  double milliseconds = 0.0;
  LevelErrors errors;
};

struct Comparison {
  std::vector<ComparisonRow> rows;
  std::vector<LevelCost> costs;
  std::vector<PatchRow> patches;
  double table_seconds = 0.0;  ///< Making the table of one Poisson's ratio takes this long.
  int contacts = 0;            ///< The exact solution answered this many contacts.
  int left_out = 0;            ///< These contacts would press the layer to more than 0.6 of its thickness.
};

constexpr double kModulus_kpa = 100.0;
constexpr double kMaxComparedShare = 0.6;
constexpr std::array<double, 5> kRatioBounds = {0.0, 1.0, 2.0, 4.0, 60.0};
const std::vector<double> kTaxelDistances_mm = {0, 1, 2, 3, 4, 6, 8, 10};

struct Task {
  Layer layer;
  Indenter indenter;
  double force;
};

std::vector<Task> tasks() {
  std::vector<Task> all;
  for (const double poisson : {0.1, 0.3, 0.45}) {
    for (const double thickness : {1.0, 2.0, 3.0}) {
      const Layer layer{thickness, poisson, kModulus_kpa};
      for (const double force : {0.1, 0.3, 1.0, 3.0, 8.0, 20.0}) {
        for (const double radius : {3.0, 6.0, 12.0, 25.0, 50.0})
          all.push_back({layer, {Shape::kSphere, radius}, force});
        for (const double radius : {1.5, 3.0, 6.0, 12.0}) all.push_back({layer, {Shape::kFlatPunch, radius}, force});
      }
      for (const double force : {0.01, 0.03, 0.1, 0.3}) {
        for (const double radius : {3.0, 10.0, 30.0}) all.push_back({layer, {Shape::kLine, radius}, force});
      }
    }
  }
  return all;
}

double microseconds_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void raise(double& worst, double value, double truth) {
  worst = std::max(worst, std::abs(value / truth - 1.0));
}

std::vector<double> taxels_of(const Layer& layer, const Contact& contact) {
  std::vector<double> values;
  for (const double r : kTaxelDistances_mm) values.push_back(taxel_dc_over_c(layer, contact, r));
  return values;
}

void raise_errors(LevelErrors& errors, const Layer& layer, const Contact& contact, const Contact& exact,
                  const std::vector<double>& exact_taxels) {
  raise(errors.indentation, contact.indentation_mm, exact.indentation_mm);
  raise(errors.contact_radius, contact.contact_radius_mm, exact.contact_radius_mm);
  raise(errors.peak_pressure, contact.peak_pressure_kpa, exact.peak_pressure_kpa);
  const std::vector<double> values = taxels_of(layer, contact);
  for (std::size_t k = 0; k < values.size(); ++k)
    errors.taxel = std::max(errors.taxel, std::abs(values[k] - exact_taxels[k]) / exact_taxels[0]);
}

std::string name_of(Shape shape) {
  return shape == Shape::kFlatPunch ? "flat punch" : shape == Shape::kLine ? "line" : "sphere";
}

class Comparer {
 public:
  Comparison run() {
    for (const Task& task : tasks()) compare(task);
    const std::array<const char*, 4> names = {"winkler", "log", "table", "fft"};
    for (std::size_t k = 0; k < names.size(); ++k) result_.costs.push_back({names[k], median(times_[k])});
    for (auto& [key, row] : rows_) result_.rows.push_back(row);
    for (const double poisson : {0.1, 0.3, 0.45}) {
      for (const double spacing : {1.0, 0.5, 0.25}) result_.patches.push_back(patch_row(poisson, spacing));
    }
    return result_;
  }

 private:
  void compare(const Task& task) {
    Contact exact;
    try {
      times_[3].push_back(microseconds_of([&] { exact = press_bonded(task.layer, task.indenter, task.force); }));
    } catch (const InputError&) {
      ++result_.left_out;
      return;
    }
    if (exact.indentation_mm > kMaxComparedShare * task.layer.thickness_mm) {
      ++result_.left_out;
      return;
    }
    ++result_.contacts;
    ComparisonRow& row = row_for(task, exact.contact_radius_mm / task.layer.thickness_mm);
    ++row.contacts;
    const ContactTable table(task.layer, table_for(task.layer));
    const std::vector<double> taxels = taxels_of(task.layer, exact);
    level(row, 0, task, exact, taxels, [&] { return press_winkler(task.layer, task.indenter, task.force); });
    level(row, 1, task, exact, taxels, [&] { return press_logarithmic(task.layer, task.indenter, task.force); });
    level(row, 2, task, exact, taxels, [&] { return table.press(task.indenter, task.force); });
  }

  void level(ComparisonRow& row, std::size_t k, const Task& task, const Contact& exact,
             const std::vector<double>& exact_taxels, const auto& press) {
    try {
      Contact contact;
      times_[k].push_back(microseconds_of([&] { contact = press(); }));
      raise_errors(row.levels[k], task.layer, contact, exact, exact_taxels);
    } catch (const InputError&) {
      ++row.levels[k].refused;
    }
  }

  ComparisonRow& row_for(const Task& task, double ratio) {
    std::size_t band = 0;
    while (band + 2 < kRatioBounds.size() && ratio >= kRatioBounds[band + 1]) ++band;
    const std::string name = name_of(task.indenter.shape);
    ComparisonRow& row = rows_[{name, task.layer.poisson, band}];
    row.indenter = name;
    row.poisson = task.layer.poisson;
    row.min_ratio = kRatioBounds[band];
    row.max_ratio = kRatioBounds[band + 1];
    return row;
  }

  const ContactTable& table_for(const Layer& layer) {
    auto& table = tables_[layer.poisson];
    if (table == nullptr) {
      table = std::make_unique<ContactTable>(layer);
      // Both halves of the table are made now, so that no look-up pays for them.
      result_.table_seconds = 1e-6 * microseconds_of([&] { (void)table->press({Shape::kSphere, 10.0}, 0.1); });
      (void)table->press({Shape::kLine, 10.0}, 0.01);
    }
    return *table;
  }

  static PatchRow patch_row(double poisson, double spacing_mm) {
    const Layer layer{2.0, poisson, kModulus_kpa};
    const Contact exact = press_bonded(layer, {Shape::kSphere, 10.0}, 1.0);
    PatchContact patch;
    const auto press = [&] { patch = press_body(layer, Body::sphere(10.0), 1.0, spacing_mm); };
    PatchRow row{poisson, exact.contact_radius_mm / spacing_mm, 0, 1e-3 * microseconds_of(press), {}};
    row.points = patch.grid.points_x;
    raise(row.errors.indentation, patch.indentation_mm, exact.indentation_mm);
    raise(row.errors.contact_radius, std::sqrt(patch.contact_area_mm2 / std::numbers::pi), exact.contact_radius_mm);
    raise(row.errors.peak_pressure, patch.peak_pressure_kpa, exact.peak_pressure_kpa);
    const std::vector<double> taxels = taxels_of(layer, exact);
    for (std::size_t k = 0; k < taxels.size(); ++k) {
      const double value = taxel_dc_over_c(layer, patch, {kTaxelDistances_mm[k], 0.0});
      row.errors.taxel = std::max(row.errors.taxel, std::abs(value - taxels[k]) / taxels[0]);
    }
    return row;
  }

  Comparison result_;
  std::array<std::vector<double>, 4> times_;
  std::map<std::tuple<std::string, double, std::size_t>, ComparisonRow> rows_;
  std::map<double, std::unique_ptr<ContactTable>> tables_;
};

std::string percent(double share) {
  return share < 0.0005 ? fmt::format("{:.3f}", 100.0 * share) : fmt::format("{:.1f}", 100.0 * share);
}

std::string errors_text(const LevelErrors& e) {
  const std::string refused = e.refused > 0 ? fmt::format(" ({} refused)", e.refused) : "";
  return fmt::format("{} / {} / {} / {}{}", percent(e.indentation), percent(e.contact_radius), percent(e.peak_pressure),
                     percent(e.taxel), refused);
}

// Writes Markdown tables.
std::string comparison_text(const Comparison& comparison) {
  std::string text = fmt::format(
      "{} contacts; {} that would press the layer to more than 0.6 of its thickness are left out. Worst error in "
      "percent "
      "against the exact layer (level fft), at given force: indentation / contact radius / peak pressure / ΔC/C of a "
      "taxel "
      "(of its peak).\n\n| indenter | ν | a/h | contacts | winkler | log | table |\n|---|---|---|---|---|---|---|\n",
      comparison.contacts, comparison.left_out);
  for (const ComparisonRow& row : comparison.rows) {
    text += fmt::format("| {} | {} | {:g} … {:g} | {} | {} | {} | {} |\n", row.indenter, row.poisson, row.min_ratio,
                        row.max_ratio, row.contacts, errors_text(row.levels[0]), errors_text(row.levels[1]),
                        errors_text(row.levels[2]));
  }
  text += "\n| level | one contact, µs (median) |\n|---|---|\n";
  for (const LevelCost& cost : comparison.costs)
    text += fmt::format("| {} | {:.3g} |\n", cost.level, cost.microseconds);
  text += fmt::format("\nThe table of one Poisson's ratio takes {:.2g} s to make.\n\n", comparison.table_seconds);
  text +=
      "The grid (FFT, conjugate gradients) against the exact layer: sphere of 10 mm, h 2 mm, 1 N.\n\n"
      "| ν | points a contact radius | patch | ms | error, percent |\n|---|---|---|---|---|\n";
  for (const PatchRow& row : comparison.patches) {
    text += fmt::format("| {} | {:.1f} | {}² | {:.3g} | {} |\n", row.poisson, row.points_per_radius, row.points,
                        row.milliseconds, errors_text(row.errors));
  }
  return text;
}

nlohmann::json numbers(const LevelErrors& e) {
  return {{"indentation", e.indentation},
          {"contact_radius", e.contact_radius},
          {"peak_pressure", e.peak_pressure},
          {"taxel", e.taxel},
          {"refused", e.refused}};
}

// The cost and the errors of each level over all contacts together, those of the grid by its spacing, and how the cost
// of finding contacts grows with taxels.
void add_numbers(nlohmann::json& result, const Comparison& comparison) {
  for (std::size_t k = 0; k < comparison.costs.size(); ++k) {
    LevelErrors all;
    std::vector<double> taxel;  // One a row, weighted alike.
    for (const ComparisonRow& row : comparison.rows) {
      if (k >= row.levels.size()) break;
      const LevelErrors& e = row.levels[k];
      all.indentation = std::max(all.indentation, e.indentation);
      all.contact_radius = std::max(all.contact_radius, e.contact_radius);
      all.peak_pressure = std::max(all.peak_pressure, e.peak_pressure);
      all.taxel = std::max(all.taxel, e.taxel);
      all.refused += e.refused;
      taxel.push_back(e.taxel);
    }
    nlohmann::json row = numbers(all);
    row["series"] = "level";
    row["level"] = comparison.costs[k].level;
    row["microseconds"] = comparison.costs[k].microseconds;
    row["median_taxel"] = median(taxel);
    result.push_back(std::move(row));
  }
  for (const PatchRow& patch : comparison.patches) {
    nlohmann::json row = numbers(patch.errors);
    row["series"] = "grid";
    row["poisson"] = patch.poisson;
    row["points_per_radius"] = patch.points_per_radius;
    row["points"] = patch.points;
    row["milliseconds"] = patch.milliseconds;
    result.push_back(std::move(row));
  }
}

// A square of taxels as dense as those of modules, ten for each, with one contact of 0.5 N in their middle, found from
// values with noise of 0.01.
nlohmann::json growth_row(const ContactTable& table, int modules, std::uint64_t seed) {
  constexpr double kForce_n = 0.5;
  Dice dice(seed);
  std::vector<Eigen::Vector2d> taxels;
  const int columns = static_cast<int>(std::lround(std::sqrt(10.0 * modules)));
  for (int t = 0; t < 10 * modules; ++t)
    taxels.emplace_back(6.5 * (t % columns) + 3.25 * (t / columns % 2), 5.63 * (t / columns));
  const Eigen::Vector2d middle = (taxels.front() + taxels.back()) / 2.0;
  const std::vector<ContactEstimate> truth{{.position_mm = middle, .force_n = kForce_n, .tip_radius_mm = 15.0}};
  const std::vector<double> values = predict_taxels(table, taxels, truth);
  std::vector<double> seconds, place, force;
  for (int draw = 0; draw < 7; ++draw) {
    std::vector<TaxelObservation> seen;
    for (std::size_t t = 0; t < taxels.size(); ++t) {
      const double noise =
          std::sqrt(-2.0 * std::log(1.0 - dice.unit())) * std::cos(2.0 * std::numbers::pi * dice.unit());
      seen.push_back({taxels[t], values[t] + 0.01 * noise});
    }
    InverseOptions options;
    options.noise_dc_over_c = 0.01;
    const double start = cli::processor_s();
    const InverseResult found = find_contacts(table, seen, options);
    seconds.push_back(cli::processor_s() - start);
    if (found.contacts.size() != 1) continue;
    place.push_back((found.contacts[0].position_mm - middle).norm());
    force.push_back(std::abs(found.contacts[0].force_n / kForce_n - 1.0));
  }
  return {{"series", "growth"},
          {"modules", modules},
          {"taxels", taxels.size()},
          {"seed", seed},
          {"found", place.size()},
          {"draws", 7},
          {"place_mm", median(place)},
          {"force_share", median(force)},
          {"processor_s", median(seconds)}};
}

nlohmann::json contact_rows(const cli::BenchOptions& options, cli::Output& /*output*/) {
  const Comparison comparison = Comparer().run();
  const InverseStudy study = study_inverse(options.quick ? 60 : 1000, 1127);
  nlohmann::json result = {{{"series", "levels"},
                            {"contacts", comparison.contacts},
                            {"left_out", comparison.left_out},
                            {"markdown", comparison_text(comparison)}},
                           {{"series", "draws"}, {"seed", study.seed}, {"markdown", study_text(study)}}};
  for (const StudyRow& row : study.rows) {
    result.push_back({{"series", "study"},
                      {"contacts", row.contacts},
                      {"draws", row.draws},
                      {"wrong_counts", row.wrong_counts},
                      {"covered", row.covered},
                      {"mean_square", row.mean_square},
                      {"position_over_bound", row.position_over_bound},
                      {"force_over_bound", row.force_over_bound},
                      {"exact_position_mm", row.exact_position_mm},
                      {"exact_force_share", row.exact_force_share}});
  }
  add_numbers(result, comparison);
  const ContactTable table(Layer{2.0, 0.3, 30.0});
  for (const int modules : {2, 4, 8, 16, 32, 64}) result.push_back(growth_row(table, modules, 23));
  return result;
}

const cli::BenchSubject kContact("contact", "contact model: levels against the exact layer, noisy draws against truth",
                                 contact_rows);

}  // namespace
}  // namespace triskin::mechanics
