// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/jobs/verify.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "offset_lines.hpp"
#include "triskin/cli/design_argument.hpp"
#include "triskin/cli/link_options.hpp"
#include "triskin/cli/stream_options.hpp"
#include "triskin/host/error.hpp"
#include "triskin/host/files.hpp"
#include "triskin/jobs/verify_report.hpp"

namespace triskin::cli {
namespace {

struct Options {
  std::string design;
  device::LinkOptions link;
  device::VerifyOptions verify;
  bool no_touch = false;
  std::string report;
};

nlohmann::json to_json(const device::Finding& f) {
  nlohmann::json j = {{"kind", device::kFindingKindNames.name(f.kind)}, {"text", f.text}, {"remedy", f.remedy}};
  j["module"] = f.module >= 0 ? nlohmann::json(f.module) : nlohmann::json(nullptr);
  j["patch"] = f.patch >= 0 ? nlohmann::json(f.patch) : nlohmann::json(nullptr);
  if (f.other >= 0) j["other"] = f.other;
  if (f.line >= 0) j["line"] = f.line;
  if (f.address >= 0) j["address"] = f.address;
  if (f.taxel >= 0) j["taxel"] = f.taxel;
  if (!f.place.empty()) j["place"] = f.place;
  return j;
}

// A person presses real modules: Enter first, then the finger; the program sees the touch by itself.
bool ask_person(int module) {
  std::cerr << "Press module " << module << " after Enter (s: skip) " << std::flush;
  std::string line;
  return std::getline(std::cin, line) && line != "s";
}

std::string extension_of(const std::string& file) {
  return std::filesystem::path(file).extension().string();
}

// Before the hardware is asked: minutes of pressing are not lost for a wrong name.
void check_report(const std::string& file) {
  const std::string extension = extension_of(file);
  if (file.empty() || extension == ".txt" || extension == ".html" || extension == ".json") return;
  throw InputError(fmt::format("--report {}: the extension says the format: .txt, .html (to print) or .json", file));
}

void write_report(const std::string& file, const design::Design& design, const device::VerifyResult& result,
                  const nlohmann::json& json) {
  if (file.empty()) return;
  const std::string extension = extension_of(file);
  write_output(file, extension == ".html"  ? device::report_html(design, result)
                     : extension == ".txt" ? device::report_text(design, result)
                                           : json.dump(1) + "\n");
}

// The patch that a code names, or −1: of none.
int patch_of(const DesignArgument& argument, const design::Design& design, const Output& output) {
  if (!argument.code) return -1;
  const int patch = argument.code->patch;
  if (patch >= static_cast<int>(design.patches.size()))
    throw InputError(fmt::format("{}: there is no controller {}; this code is of another sheet", argument.path, patch));
  output.say(fmt::format("{}, page {} of its assembly sheet{}", argument.path, argument.code->page,
                         patch < 0 ? "" : fmt::format(": controller {}", patch)));
  return patch;
}

int run(Options options, Output& output) {
  check_report(options.report);
  const DesignArgument argument = find_design(options.design);
  const design::Design design = design::read_intact_design(argument.path);
  const int patch = patch_of(argument, design, output);
  const auto link = device::open_link(options.link, &design);
  // The virtual finger costs nobody anything, so it always tries every module.
  if (link->finger() != nullptr) options.verify.touch = !options.no_touch;
  const auto wiring = design::wiring_of(design);
  // A person at one patch is asked for its modules only.
  options.verify.ask = [&](int module) {
    return (patch < 0 || wiring.at(static_cast<std::size_t>(module)).patch == patch) && ask_person(module);
  };
  device::Bus bus(*link);
  device::VerifyResult r = device::verify(bus, design, options.verify, output.progress());
  if (patch >= 0) std::ranges::stable_partition(r.findings, [patch](const auto& f) { return f.patch == patch; });
  nlohmann::json findings = nlohmann::json::array();
  for (const auto& f : r.findings) {
    findings.push_back(to_json(f));
    const std::string place = f.place.empty() ? "" : fmt::format("\n    on the cover: {}", f.place);
    output.say(fmt::format("{}: {}{}\n    {}", device::kFindingKindNames.name(f.kind), f.text, place, f.remedy));
  }
  nlohmann::json earlier = nlohmann::json::array();
  for (const auto& f : r.earlier) {
    earlier.push_back(to_json(f));
    output.say(fmt::format("remembered from before, not there now: {}", f.text));
  }
  output.result = {{"modules_ok", r.modules_ok},    {"modules", r.modules},
                   {"touched", r.touched},          {"findings", std::move(findings)},
                   {"earlier", std::move(earlier)}, {"offsets", say_offsets(bus, design, output)}};
  if (r.stream) {
    add_stream_keys(*r.stream, output);
    for (const std::string& line : sentences(*r.stream)) output.say(line);
  }
  write_report(options.report, design, r, output.result);
  output.say(fmt::format("{} of {} modules ok, {} touched; {} findings", r.modules_ok, r.modules, r.touched,
                         r.findings.size()));
  return r.findings.empty() ? 0 : 1;
}

const Registration kVerify{{
    "verify",
    "ask the hardware whether it is the design: controllers, tables, modules, taxels",
    "triskin verify forearm.json --link sim --touch",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("DESIGN", options->design, "design file, or the text of a QR code of its assembly sheet")
          ->required();
      add_link_options(app, options->link);
      app.add_flag("--touch", options->verify.touch,
                   "press every module in turn; simulated links have a finger of their own and always do");
      app.add_flag("--no-touch", options->no_touch, "only ask, also on a simulated link");
      app.add_option("--report", options->report, "also write a report: FILE.txt, FILE.html to print, or FILE.json");
      app.add_option("--watch-s", options->verify.watch_s, "least time in which faults that come and go are collected")
          ->check(CLI::Range(0.0, 86400.0))
          ->capture_default_str();
      return [options](Output& output) { return run(*options, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli
