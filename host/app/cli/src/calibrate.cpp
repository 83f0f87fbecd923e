// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/skin/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <iostream>
#include <memory>
#include <utility>
#include <vector>

#include "module_ids.hpp"
#include "site_options.hpp"
#include "stream_options.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/files.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/skin/keep_calibration.hpp"

namespace triskin::cli::calibrate_command {
namespace {

struct Options {
  SiteOptions site;
  std::vector<double> steps_kpa, weights_g;
  std::string ramp, from, output;
  double foot_mm2 = 0.0;  // Zero stands for the area of a module.
  skin::CalibrateOptions calibrate;
  std::string modules;  // An empty text stands for all.
  bool by_hand = false, forget = false;
};

constexpr double kNewtonPerGram = 9.80665e-3;
constexpr double kKpaPerNewtonPerMm2 = 1000.0;
constexpr double kMinError_percent = 0.01, kMinError_kpa = 0.001;
constexpr std::size_t kMaxNamed = 12;  // More taxels are not listed one by one.

// Returns the pressure that a weight of 1 g causes on the foot.
double kpa_per_gram(const Options& options, const design::Design& design) {
  const double foot_mm2 =
      options.foot_mm2 > 0.0 ? options.foot_mm2 : design::module_area_mm2(design.layout.corner_cut_mm);
  return kKpaPerNewtonPerMm2 * kNewtonPerGram / foot_mm2;
}

std::string request_of(const design::Design& design, const skin::PressureStep& step, double kpa_of_gram) {
  if (step.pressure_kpa == 0.0) return "leave the skin untouched";
  if (step.module < 0) return fmt::format("bring the whole skin under {:g} kPa", step.pressure_kpa);
  return fmt::format("put {:.6g} g on module {} ({:.3g} kPa)", step.pressure_kpa / kpa_of_gram,
                     design::number_of(design, step.module), step.pressure_kpa);
}

// Asks a person to apply the step and to confirm it with Enter.
void ask_person(const std::string& request) {
  say_aside(request + ", then press Enter");
  std::string line;
  if (!std::getline(std::cin, line))
    throw InputError("calibrate waits for Enter after each step, and standard input has ended; run it in a terminal");
  if (interrupt_request()) throw Cancelled("stopped by the user");
}

// Returns the modules of --modules in ascending order; none stands for all.
std::vector<layout::ModuleId> chosen_modules(const Options& options, const design::Design& design) {
  std::vector<layout::ModuleId> chosen = modules_named(design, "--modules", options.modules);
  std::ranges::sort(chosen);
  chosen.erase(std::ranges::unique(chosen).begin(), chosen.end());
  const std::vector<layout::ModuleId> here = skin::wanted_modules(design, {});
  for (const layout::ModuleId module : chosen) {
    if (!std::ranges::binary_search(here, module))
      throw InputError(fmt::format("--modules: there is no module {} here; there are {}",
                                   design::number_of(design, module), modules_text(design, here)));
  }
  return chosen;
}

// Presses step by step with the actuator, or asks a person to.
skin::CalibrationOutcome measure_steps(const Options& options, session::Bus& bus, skin::LiveCover& cover,
                                       skin::CalibrateOptions calibrate) {
  const design::Design& design = cover.design();
  const bool by_module = !options.weights_g.empty();
  calibrate.method = by_module ? wire::CalibrationMethod::kWeights : wire::CalibrationMethod::kSteps;
  const double of_gram = kpa_per_gram(options, design);
  std::vector<double> pressures = options.steps_kpa;
  for (const double g : options.weights_g) pressures.push_back(g * of_gram);
  const auto in_turn = by_module ? skin::wanted_modules(design, calibrate) : std::vector<layout::ModuleId>{};
  const auto steps = skin::pressure_steps(pressures, in_turn);
  link::TouchActuator* actuator = options.by_hand ? nullptr : cover.actuator();
  layout::ModuleId pressed = layout::ModuleId::none();
  calibrate.apply = [&](const skin::PressureStep& step) {
    if (interrupt_request()) throw Cancelled("stopped by the user");
    if (actuator == nullptr) return ask_person(request_of(design, step, of_gram));
    if (pressed != step.module) actuator->pressurize(pressed, 0.0);
    actuator->pressurize(pressed = step.module, step.pressure_kpa);
  };
  auto outcome = skin::calibrate_by_steps(bus, design, steps, calibrate);
  if (actuator != nullptr) actuator->pressurize(pressed, 0.0);
  return outcome;
}

skin::CalibrationOutcome measure(const Options& options, skin::LiveBus& live, skin::LiveCover& cover, Output& output) {
  skin::CalibrateOptions calibrate = options.calibrate;
  calibrate.stream = speaking(calibrate.stream);
  calibrate.unix_minus_link_ns = live.unix_ns(0);
  calibrate.progress = output.progress();
  if (options.ramp.empty()) return measure_steps(options, live.bus(), cover, std::move(calibrate));
  const skin::PressureRamp ramp(options.ramp);
  if (!ramp.note().empty()) output.say(ramp.note());
  if (!ramp.by_calendar() && cover.actuator() == nullptr)
    throw InputError(
        fmt::format("{}: times of the link are known of simulated links only; give the column unix_s", options.ramp));
  calibrate.method = wire::CalibrationMethod::kRamp;
  return skin::calibrate_by_ramp(live.bus(), cover.design(), ramp, calibrate);
}

// Returns the modules that were wanted and not measured, as --modules takes them.
std::string rest_of(const skin::CalibrateOptions& options, const design::Design& design,
                    std::span<const layout::ModuleId> measured) {
  std::vector<layout::ModuleId> wanted = skin::wanted_modules(design, options);
  std::erase_if(wanted, [&](layout::ModuleId module) { return std::ranges::binary_search(measured, module); });
  return modules_text(design, wanted);
}

// A simulation without noise has errors far below what anybody can measure.
std::string at_least(double value, double smallest, const char* unit) {
  return value < smallest ? fmt::format("below {:g} {}", smallest, unit) : fmt::format("{:.2g} {}", value, unit);
}

nlohmann::json report_uncalibrated(const design::Design& design, const skin::CalibrationOutcome& outcome,
                                   const Output& output) {
  for (std::size_t k = 0; k < std::min(kMaxNamed, outcome.without.size()); ++k)
    output.say(fmt::format("module {} taxel {}: not calibrated: it does not follow the pressure; run triskin verify",
                           design::number_of(design, outcome.without[k].module), outcome.without[k].taxel));
  if (outcome.without.size() > kMaxNamed)
    output.say(fmt::format("… and {} more", counted(outcome.without.size() - kMaxNamed, "taxel")));
  nlohmann::json without = nlohmann::json::array();
  for (const auto& [module, taxel] : outcome.without)
    without.push_back({{"module", design::number_of(design, module)}, {"taxel", taxel}});
  return without;
}

void print_report(const design::Design& design, const skin::CalibrationOutcome& outcome, Output& output) {
  const design::CalibrationQuality& q = outcome.quality;
  output.say(fmt::format(
      "{} of {} calibrated up to {:g} kPa; error of a sensitivity {} (median), {} (worst), 95 % bound; "
      "farthest from the line {}",
      q.taxels, counted(q.taxels + q.missing, "taxel"), q.max_kpa, at_least(q.median_percent, kMinError_percent, "%"),
      at_least(q.worst_percent, kMinError_percent, "%"), at_least(q.residual_kpa, kMinError_kpa, "kPa")));
  nlohmann::json without = report_uncalibrated(design, outcome, output);
  output.result = {{"taxels", q.taxels},
                   {"median_percent", q.median_percent},
                   {"worst_percent", q.worst_percent},
                   {"residual_kpa", q.residual_kpa},
                   {"most_kpa", q.max_kpa},
                   {"without", std::move(without)}};
}

// Says which controllers store their calibration. A controller that does not is named, and this computer stores it
// instead.
nlohmann::json rows_of(const std::vector<skin::KeptCalibration>& kept, Output& output) {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& [board, in_controller] : kept) {
    output.say(
        in_controller
            ? fmt::format("controller {}  keeps revision {} of its calibration", board.serial, board.revision)
            : fmt::format(
                  "controller {}  did not accept revision {} of its calibration, so only this computer has it: its "
                  "firmware is too old (triskin flash --firmware), or its table is of another design (triskin flash)",
                  board.serial, board.revision));
    rows.push_back({{"serial", board.serial},
                    {"revision", board.revision},
                    {"made", board.made},
                    {"in_controller", in_controller}});
  }
  return rows;
}

void keep(const Options& options, skin::LiveBus& bus, skin::LiveCover& cover, skin::CalibrationOutcome outcome,
          Output& output) {
  const auto kept = skin::keep_calibration(bus, cover, std::move(outcome));
  output.result["boards"] = rows_of(kept, output);
  if (options.output.empty()) return;
  std::vector<design::BoardCalibration> boards;
  for (const skin::KeptCalibration& k : kept) boards.push_back(k.board);
  write_output(options.output, design::calibration_text(boards));
  output.result["file"] = options.output;
}

int forget(skin::LiveBus& bus, const skin::LiveCover& cover, Output& output) {
  const std::vector<std::string> forgotten = skin::forget_calibration(bus, cover);
  for (const std::string& serial : forgotten) output.say(fmt::format("controller {}  calibration forgotten", serial));
  output.say(fmt::format("{} {} forgotten", counted(forgotten.size(), "calibration"),
                         agreeing(forgotten.size(), "was", "were")));
  output.result = {{"forgotten", forgotten}};
  return 0;
}

// Nothing is measured: the calibrations of a file are written to their controllers and stored here.
int write_again(const Options& options, skin::LiveBus& bus, const skin::LiveCover& cover, Output& output) {
  const auto kept = skin::keep_calibration_file(bus, cover, options.from);
  if (kept.empty())
    throw InputError(fmt::format("--from {}: no entry for any controller of {} that answers; nothing was written",
                                 options.from, cover.design().name));
  output.result = {{"boards", rows_of(kept, output)}};
  return std::ranges::all_of(kept, &skin::KeptCalibration::in_controller) ? 0 : 1;
}

void require_one_way(const Options& options) {
  const int ways = (options.steps_kpa.empty() ? 0 : 1) + (options.weights_g.empty() ? 0 : 1) +
                   (options.ramp.empty() ? 0 : 1) + (options.from.empty() ? 0 : 1) + (options.forget ? 1 : 0);
  if (ways != 1)
    throw InputError("calibrate: say what presses, with one of --steps, --weights and --ramp; or --from, or --forget");
}

int run(const Options& options, Output& output) {
  require_one_way(options);
  const skin::LiveSkin skin = open_skin(options.site, output);
  skin::LiveCover& cover = one_cover(skin, "calibrate");
  skin::LiveBus& bus = *skin.buses().front();
  if (options.forget) return forget(bus, cover, output);
  if (!options.from.empty()) return write_again(options, bus, cover, output);
  Options own = options;
  const std::array streamed{&cover.design()};
  own.calibrate.stream = robot::stream_options(bus.config(), streamed, own.calibrate.stream);
  own.calibrate.modules = chosen_modules(own, cover.design());
  skin::CalibrationOutcome outcome = measure(own, bus, cover, output);
  print_report(cover.design(), outcome, output);
  if (outcome.quality.taxels == 0) {
    output.say("no taxel followed the pressure: nothing was kept");
    return 1;
  }
  const bool complete = outcome.without.empty();
  const std::string rest = rest_of(own.calibrate, cover.design(), outcome.measured);
  keep(own, bus, cover, std::move(outcome), output);
  if (!rest.empty())
    output.say(fmt::format("stopped early; the results so far are kept, and --modules {} does the rest", rest));
  output.result["left"] = rest;
  return complete && rest.empty() ? 0 : 1;
}

const Registration kCalibrate{{
    "calibrate",
    "find what the counts of each taxel are worth in kPa, from pressures or weights that are known",
    "triskin calibrate forearm.json --link can:can0 --steps 5,10,20,30,40",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      add_site_options(app, options->site);
      app.add_option("--steps", options->steps_kpa,
                     "pressures on the whole skin in kPa, such as from an air bag with a gauge")
          ->delimiter(',')
          ->check(CLI::Range(0.01, 1000.0));
      app.add_option("--weights", options->weights_g, "weights on a foot in g, asked for on each module in turn")
          ->delimiter(',')
          ->check(CLI::Range(0.1, 1e5));
      app.add_option("--foot-mm2", options->foot_mm2, "with --weights: area of the foot; default: that of a module")
          ->check(CLI::Range(1.0, 1e5));
      app.add_option(
          "--ramp", options->ramp,
          "gauge file with lines \"unix_s,kpa\", written while the pressure on the whole skin rises and falls");
      app.add_option("--from", options->from,
                     "measure nothing; write the calibrations in this file into their controllers");
      app.add_option("--modules", options->modules, "calibrate only these modules, as 3,7-9; the others keep theirs");
      app.add_option("-o,--output", options->output, "also writes the calibration into this file");
      app.add_option("--settle-s", options->calibrate.settle_s, "time to settle after each step")
          ->check(CLI::Range(0.0, 600.0))
          ->capture_default_str();
      app.add_option("--hold-s", options->calibrate.hold_s, "time that is averaged after settling")
          ->check(CLI::Range(0.1, 600.0))
          ->capture_default_str();
      app.add_option("--gauge-percent", options->calibrate.gauge_percent,
                     "error of the gauge or weights, added to that of every taxel")
          ->check(CLI::Range(0.0, 50.0))
          ->capture_default_str();
      app.add_option("--max-error-percent", options->calibrate.max_error_percent,
                     "taxels with a larger error stay uncalibrated")
          ->check(CLI::Range(0.01, 100.0))
          ->capture_default_str();
      app.add_flag("--by-hand", options->by_hand, "ask for every step on simulated links too");
      app.add_flag("--forget", options->forget, "forget the calibrations of the design's controllers, there and here");
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kHardware,
}};

}  // namespace
}  // namespace triskin::cli::calibrate_command
