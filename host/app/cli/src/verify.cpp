// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/diagnose/verify.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <memory>
#include <mutex>
#include <utility>

#include "design_argument.hpp"
#include "finding_lines.hpp"
#include "offset_lines.hpp"
#include "site_options.hpp"
#include "stream_options.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/base/lower_case.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/diagnose/design_files.hpp"
#include "triskin/diagnose/repair.hpp"
#include "triskin/diagnose/verify_report.hpp"
#include "triskin/session/controller_calibration.hpp"

namespace triskin::cli::verify_command {
namespace {

struct Options {
  SiteOptions site;
  diagnose::VerifyOptions verify;
  bool no_touch = false;
  std::string report;
};

// A person presses real modules: Enter first, then the finger; the program notices the touch itself. Only one question
// is open at a time, even if several buses are verified.
bool ask_person(const std::string& cover, design::ModuleNumber module) {
  static std::mutex one;
  const std::lock_guard lock(one);
  std::cerr << cover << "Press module " << module.value << " after Enter (s: skip) " << std::flush;
  std::string line;
  return std::getline(std::cin, line) && line != "s";
}

// Fails before the hardware is used, so that a wrong name does not cost minutes of pressing.
void check_report(const std::string& file) {
  const std::string extension = extension_of(file);
  if (file.empty() || extension == ".txt" || extension == ".html" || extension == ".json") return;
  throw InputError(fmt::format("--report {}: the extension says the format: .txt, .html (to print) or .json", file));
}

// For a robot, FILE.html becomes FILE_COVER.html.
std::string report_file(const std::string& file, const robot::CoverConfig& cover, const robot::BusConfig& bus) {
  const std::filesystem::path path(file);
  if (file.empty() || cover.name.empty()) return file;
  const bool divided = design::patches_of(cover.design) != design::patches_here(cover.design);
  const std::string of_bus = divided ? "_" + bus.name : "";
  return (path.parent_path() / (path.stem().string() + "_" + cover.name + of_bus + path.extension().string())).string();
}

void write_report(const std::string& file, const design::Design& design, const diagnose::VerifyResult& result,
                  const nlohmann::json& json, const std::string& arguments) {
  if (file.empty()) return;
  const std::string extension = extension_of(file);
  write_output(file, extension == ".html"  ? diagnose::report_html(design, result, arguments)
                     : extension == ".txt" ? diagnose::report_text(design, result, arguments)
                                           : json.dump(1) + "\n");
}

// Returns the patch that a code names, or −1.
layout::PatchIndex patch_of(const DesignArgument& argument, const design::Design& design, const Output& output) {
  if (!argument.code) return layout::PatchIndex::none();
  const layout::PatchIndex patch{argument.code->patch};
  if (patch >= 0 && !design::has_patch(design, patch))
    throw InputError(fmt::format("{}: there is no controller {}; this code is of another sheet", argument.path, patch));
  output.say(fmt::format("{}, page {} of its assembly sheet{}", argument.path, argument.code->page,
                         patch < 0 ? "" : fmt::format(": controller {}", patch)));
  return patch;
}

// Findings on one cover, which are reported when all buses are done.
struct Told {
  diagnose::VerifyResult result;
  nlohmann::json keys;
  std::vector<std::string> lines;
};

// Returns the arguments after `triskin flash` and `triskin verify` in the steps of a repair.
std::string arguments_of(const Options& options, const robot::CoverConfig& cover) {
  const connect::LinkOptions& link = options.site.link;
  return options.site.file + (cover.name.empty() ? "" : " --cover " + cover.name) +
         (link.chosen || cover.name.empty() ? " --link " + link.link : "") +
         (link.scene.empty() ? "" : " --scene " + link.scene);
}

nlohmann::json read_calibration_lines(skin::LiveBus& live, const design::Design& design,
                                      std::vector<std::string>& lines) {
  nlohmann::json calibrations = nlohmann::json::array();
  live.find_controllers(skin::RestSource::kPresent);
  for (const design::BoardCalibration& b : session::kept_in_controllers(live.bus(), design, live.claims())) {
    calibrations.push_back({{"serial", b.serial}, {"revision", b.revision}, {"made", b.made}});
    lines.push_back(fmt::format("controller {} keeps revision {} of its calibration, made {} with {} up to {:g} kPa",
                                b.serial, b.revision, b.made, design::kCalibrationMethodNames.name(b.method),
                                b.max_kpa));
  }
  return calibrations;
}

// Prints each finding with its repair steps, for the report and --json.
Told print_report(const robot::CoverConfig& cover, diagnose::VerifyResult r, skin::LiveBus& live,
                  const std::string& arguments) {
  Told told;
  const std::string name = prefix_of(cover);
  nlohmann::json findings = nlohmann::json::array(), earlier = nlohmann::json::array();
  for (const auto& f : r.findings) {
    const std::vector<std::string> steps = diagnose::repair_steps(cover.design, f, arguments);
    findings.push_back(finding_json(cover.design, f));
    findings.back()["repair"] = steps;
    for (const std::string& line : finding_lines(f, steps)) told.lines.push_back(name + line);
  }
  for (const auto& f : r.earlier) {
    earlier.push_back(finding_json(cover.design, f));
    told.lines.push_back(fmt::format("{}remembered from before, not there now: {}", name, f.text));
  }
  std::vector<std::string> rest;
  nlohmann::json calibrations = read_calibration_lines(live, cover.design, rest);
  told.keys = {{"modules_ok", r.modules_ok},
               {"modules", r.modules},
               {"touched", r.touched},
               {"findings", std::move(findings)},
               {"earlier", std::move(earlier)},
               {"offsets", read_offset_lines(live.bus(), cover.design, rest)},
               {"calibrations", std::move(calibrations)}};
  if (r.stream) {
    add_stream_keys(*r.stream, told.keys);
    for (std::string& line : sentences(*r.stream, "see the findings")) rest.push_back(std::move(line));
  }
  for (const std::string& line : rest) told.lines.push_back(name + line);
  if (!r.findings.empty()) told.lines.push_back(name + "fix the findings one by one: triskin repair " + arguments);
  told.result = std::move(r);
  return told;
}

// If `patch` ≥ 0, its findings come first, and a person is asked only for its modules.
std::vector<Told> verify_bus(skin::LiveBus& live, const Options& options, layout::PatchIndex patch,
                             const ProgressSink& progress) {
  std::vector<Told> all;
  const robot::BusConfig& site = live.config();
  live.find_controllers();
  for (skin::LiveCover& own : live.covers()) {
    const robot::CoverConfig& cover = own.config();
    diagnose::VerifyOptions verify = options.verify;
    verify.actuator = own.actuator();
    // A simulated touch needs no person, so every module is tried.
    if (verify.actuator != nullptr) verify.touch = !options.no_touch;
    verify.neighbours = robot::other_demands(site, std::array{&std::as_const(cover.design)});
    verify.rest = own.kept_rest();
    const auto wiring = design::wiring_of(cover.design);
    // A person at one patch is asked only for its modules.
    verify.ask = [&](layout::ModuleId module) {
      const bool is_asked = patch < 0 || wiring.at(static_cast<std::size_t>(module)).patch == patch;
      return is_asked && ask_person(prefix_of(cover), design::number_of(cover.design, module));
    };
    diagnose::VerifyResult result =
        diagnose::verify(live.bus(), cover.design, verify, progress_of(site, cover, progress));
    diagnose::name_files(result.findings, options.site.file);
    if (patch >= 0) std::ranges::stable_partition(result.findings, [=](const auto& f) { return f.patch == patch; });
    const std::string arguments = arguments_of(options, cover);
    all.push_back(print_report(cover, std::move(result), live, arguments));
    all.back().keys.update(keys_of(site, cover));
    write_report(report_file(options.report, cover, site), cover.design, all.back().result, all.back().keys, arguments);
  }
  return all;
}

int say_all(const std::vector<std::vector<Told>>& buses, bool is_robot, Output& output) {
  int modules_ok = 0, modules = 0, touched = 0;
  std::size_t findings = 0;
  nlohmann::json covers = nlohmann::json::array();
  for (const auto& bus : buses) {
    for (const Told& told : bus) {
      for (const std::string& line : told.lines) output.say(line);
      modules_ok += told.result.modules_ok;
      modules += told.result.modules;
      touched += told.result.touched;
      findings += told.result.findings.size();
      covers.push_back(told.keys);
    }
  }
  if (is_robot)
    output.result = {{"modules_ok", modules_ok},
                     {"modules", modules},
                     {"touched", touched},
                     {"findings", findings},
                     {"covers", covers}};
  else
    output.result = covers[0];
  output.say(fmt::format("{} of {} ok, {} touched; {}", modules_ok, counted(modules, "module"), touched,
                         counted(findings, "finding")));
  return findings == 0 ? 0 : 1;
}

int run(Options options, Output& output) {
  check_report(options.report);
  const DesignArgument argument = find_design(options.site.file);
  options.site.file = argument.path;
  skin::LiveSkin skin = open_skin(options.site, output);
  const layout::PatchIndex patch = patch_of(argument, skin.site().buses[0].covers[0].design, output);
  std::vector<std::vector<Told>> buses(skin.buses().size());
  const ProgressSink progress = output.progress();
  try {
    skin.on_each_bus([&](skin::LiveBus& bus) { buses[bus.index()] = verify_bus(bus, options, patch, progress); });
  } catch (const Error&) {
    // Reports the findings on the other buses.
    if (buses.size() > 1) (void)say_all(buses, skin.site().is_robot, output);
    throw;
  }
  return say_all(buses, skin.site().is_robot, output);
}

const Registration kVerify{{
    "verify",
    "check the hardware against the design: controllers, tables, modules, taxels",
    "triskin verify forearm.json --link sim --touch",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      add_site_options(app, options->site);
      app.add_flag("--touch", options->verify.touch, "press every module in turn (always on simulated links)");
      app.add_flag("--no-touch", options->no_touch, "only ask, even on a simulated link");
      app.add_option("--report", options->report, "also write a report: FILE.txt, FILE.html to print, or FILE.json");
      app.add_option("--elf", options->verify.elf,
                     "image of the firmware (triskin_app_a.elf or _b): names function and line of a crash");
      app.add_option("--watch-s", options->verify.watch_s, "shortest time in which intermittent faults are collected")
          ->check(CLI::Range(0.0, 86400.0))
          ->capture_default_str();
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kHardware,
}};

}  // namespace
}  // namespace triskin::cli::verify_command
