// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mechanics/contact.hpp"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/mechanics/inverse_file.hpp"
#include "triskin/mechanics/taxel.hpp"

namespace triskin::cli::contact_command {
namespace {

using mechanics::Level;
using mechanics::Shape;

struct Options {
  std::optional<double> sphere_mm, punch_mm, line_mm;
  mechanics::Layer layer;
  double force_n = 1.0;
  double disc_mm = 4.0;
  Level level = Level::kFft;
  std::string inverse;
};

const std::vector<double> kRadii_mm = {0, 1, 2, 3, 4, 6, 8, 10};

mechanics::Indenter indenter_of(const Options& options) {
  const int named = (options.sphere_mm ? 1 : 0) + (options.punch_mm ? 1 : 0) + (options.line_mm ? 1 : 0);
  if (named != 1) throw InputError("contact: say what presses: one of --sphere-mm, --punch-mm and --line-mm");
  if (options.sphere_mm) return {Shape::kSphere, *options.sphere_mm};
  if (options.punch_mm) return {Shape::kFlatPunch, *options.punch_mm};
  return {Shape::kLine, *options.line_mm};
}

nlohmann::json sampled(const auto& value) {
  nlohmann::json list = nlohmann::json::array();
  for (const double r : kRadii_mm) list.push_back(value(r));
  return list;
}

nlohmann::json contact_json(const Options& options, const mechanics::Contact& contact) {
  return {{contact.is_line ? "force_n_per_mm" : "force_n", contact.force},
          {"indentation_mm", contact.indentation_mm},
          {"indentation_share", contact.indentation_mm / options.layer.thickness_mm},
          {"contact_radius_mm", contact.contact_radius_mm},
          {"peak_pressure_kpa", contact.peak_pressure_kpa},
          {"radii_mm", kRadii_mm},
          {"surface_displacement_mm", sampled([&](double r) { return contact.field->displacement_mm(r); })},
          {"base_pressure_kpa", sampled([&](double r) { return contact.field->base_pressure_kpa(r); })},
          {"taxel_dc_over_c",
           sampled([&](double r) { return mechanics::taxel_dc_over_c(options.layer, contact, r, options.disc_mm); })}};
}

void say_contact(const Output& output, const nlohmann::json& j) {
  output.say(fmt::format("indentation {:.4f} mm, contact radius {:.3f} mm, peak pressure {:.3f} kPa",
                         j["indentation_mm"].get<double>(), j["contact_radius_mm"].get<double>(),
                         j["peak_pressure_kpa"].get<double>()));
  output.say("  mm from centre   displacement, mm   base, kPa   dC/C");
  for (std::size_t k = 0; k < kRadii_mm.size(); ++k) {
    output.say(fmt::format("  {:>14} {:>18.5f} {:>11.4f} {:>8.4f}", kRadii_mm[k],
                           j["surface_displacement_mm"][k].get<double>(), j["base_pressure_kpa"][k].get<double>(),
                           j["taxel_dc_over_c"][k].get<double>()));
  }
  // A linear layer is 3 … 12 % too soft at a fifth of its thickness (docs/mechanics.md).
  if (j["indentation_share"].get<double>() > 0.2)
    output.say("note: the indentation exceeds a fifth of the layer; a real layer is stiffer there (docs/mechanics.md)");
}

nlohmann::json estimate_json(const mechanics::ContactEstimate& c) {
  return {{"position_mm", {c.position_mm.x(), c.position_mm.y()}},
          {"position_sd_mm", {c.position_sd_mm.x(), c.position_sd_mm.y()}},
          {"force_n", c.force_n},
          {"force_sd_n", c.force_sd_n},
          {"tip_radius_mm", c.tip_radius_mm},
          {"tip_radius_sd_mm", c.tip_radius_sd_mm},
          {"contact_radius_mm", c.contact_radius_mm},
          {"indentation_mm", c.indentation_mm}};
}

void say_estimate(const Output& output, const mechanics::ContactEstimate& c) {
  output.say(fmt::format("  at {:.2f}, {:.2f} mm (± {:.2f}, {:.2f})  {:.3f} N (± {:.3f})  tip {:.1f} mm (± {:.1f})",
                         c.position_mm.x(), c.position_mm.y(), c.position_sd_mm.x(), c.position_sd_mm.y(), c.force_n,
                         c.force_sd_n, c.tip_radius_mm, c.tip_radius_sd_mm));
}

nlohmann::json report_estimates(const std::vector<mechanics::ContactEstimate>& estimates, const Output& output) {
  nlohmann::json list = nlohmann::json::array();
  for (const mechanics::ContactEstimate& e : estimates) {
    list.push_back(estimate_json(e));
    say_estimate(output, e);
  }
  return list;
}

int run_inverse(const Options& options, Output& output) {
  const auto cases = mechanics::read_inverse_cases(options.inverse);
  const auto results = mechanics::solve_inverse_cases(cases);
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const mechanics::InverseResult& result = results[k];
    output.say(fmt::format("case {}: {}, noise {:.2g}", cases[k].id.dump(), counted(result.contacts.size(), "contact"),
                           result.noise_dc_over_c));
    list.push_back({{"id", cases[k].id},
                    {"contacts", report_estimates(result.contacts, output)},
                    {"noise_dc_over_c", result.noise_dc_over_c},
                    {"residual_dc_over_c", result.residual_dc_over_c}});
  }
  output.result = {{"cases", std::move(list)}};
  return 0;
}

int run(const Options& options, Output& output) {
  if (!options.inverse.empty()) return run_inverse(options, output);
  const mechanics::Indenter indenter = indenter_of(options);
  output.result = contact_json(options, mechanics::press(options.level, options.layer, indenter, options.force_n));
  say_contact(output, output.result);
  return 0;
}

const std::map<std::string, Level> kLevels = {
    {"winkler", Level::kWinkler}, {"log", Level::kLogarithmic}, {"table", Level::kTable}, {"fft", Level::kFft}};

void add_options(CLI::App& app, Options& options) {
  app.add_option("--sphere-mm", options.sphere_mm, "a sphere of this radius presses");
  app.add_option("--punch-mm", options.punch_mm, "a flat circular punch of this radius presses");
  app.add_option("--line-mm", options.line_mm,
                 "a cylinder of this radius lies on the layer; --force-n is then N per mm");
  app.add_option("--layer-mm", options.layer.thickness_mm, "thickness of the layer")->capture_default_str();
  app.add_option("--poisson", options.layer.poisson, "Poisson's ratio of the layer, 0 … 0.5")->capture_default_str();
  app.add_option("--modulus-kpa", options.layer.modulus_kpa, "Young's modulus of the layer")->capture_default_str();
  app.add_option("--force-n", options.force_n, "force that presses")->capture_default_str();
  app.add_option("--level", options.level, "model of the layer, from fast to exact")
      ->transform(one_of(kLevels))
      ->default_str("fft");
  app.add_option("--inverse", options.inverse,
                 "find the contacts that explain the taxels of this file (docs/mechanics.md)");
}

const Registration kContact{{
    "contact",
    "compute one contact on the soft layer: pressure, displacement and what taxels see",
    "triskin contact --sphere-mm 5 --layer-mm 2 --poisson 0.3 --modulus-kpa 100 --force-n 0.5",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      add_options(app, *options);
      return [options](Output& output) { return run(*options, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli::contact_command
