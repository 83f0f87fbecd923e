// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/diagnose/repair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <tuple>

#include "finding_lines.hpp"
#include "site_options.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/diagnose/design_files.hpp"

namespace triskin::cli::repair_command {
namespace {

struct Options {
  SiteOptions site;
  diagnose::VerifyOptions verify;
  bool no_touch = false;
};

enum class Answer { kDone, kSkip, kQuit };

// Two findings are the same if these fields are equal; their text may have changed.
auto identity(const diagnose::Finding& f) {
  return std::tuple(f.kind, f.patch, f.module, f.other, f.line, f.address, f.taxel);
}
bool same(const diagnose::Finding& a, const diagnose::Finding& b) {
  return identity(a) == identity(b);
}

// The question ends with a line break, so that another program can answer it.
Answer ask(Output& output, const std::string& question) {
  output.say(question + " Enter: done; s: skip it; q: end");
  std::cout.flush();
  std::string line;
  if (!std::getline(std::cin, line) || line == "q") return Answer::kQuit;
  return line == "s" ? Answer::kSkip : Answer::kDone;
}

class Repair {
 public:
  Repair(const Options& options, Output& output) : options_(options), output_(output) { open(); }

  int run() {
    auto findings = check();
    const std::size_t at_first = findings.size();
    output_.say(counted(at_first, "finding"));
    while (const diagnose::Finding* next = next_of(findings)) {
      const Answer answer = show(*next, findings.size());
      if (answer == Answer::kQuit) break;
      if (answer == Answer::kSkip) {
        skipped_.push_back(*next);
        continue;
      }
      const diagnose::Finding mended = *next;
      findings = check_again(mended);
    }
    const bool tares = needs_tare_ && ask(output_, "Finally, tare: remove everything from the skin.") == Answer::kDone;
    if (tares) tare();
    output_.result = {{"findings_before", at_first},
                      {"mended", mended_},
                      {"skipped", skipped_.size()},
                      {"tared", tared_},
                      {"findings", json_}};
    output_.say(
        fmt::format("{} mended, {} skipped; {} left", mended_, skipped_.size(), counted(findings.size(), "finding")));
    return findings.empty() ? 0 : 1;
  }

 private:
  [[nodiscard]] skin::LiveCover& live_cover() const { return one_cover(*skin_, "repair"); }
  [[nodiscard]] const robot::CoverConfig& cover() const { return live_cover().config(); }
  [[nodiscard]] skin::LiveBus& live_bus() const { return *skin_->buses().at(0); }
  [[nodiscard]] session::Bus& bus() const { return live_bus().bus(); }

  // The supply was off during the repair, and a USB board is a new device afterwards.
  void open() {
    skin_.reset();
    skin_ = std::make_unique<skin::LiveSkin>(open_skin(options_.site, output_));
  }

  std::vector<diagnose::Finding> check(const diagnose::Finding* about = nullptr) {
    diagnose::VerifyOptions verify = options_.verify;
    verify.actuator = live_cover().actuator();
    if (verify.actuator != nullptr) verify.touch = !options_.no_touch;
    live_bus().find_controllers();
    verify.rest = live_cover().kept_rest();
    verify.ask = [&](layout::ModuleId module) { return asks_for(about, module) && ask_for_press(module); };
    diagnose::VerifyResult result = diagnose::verify(bus(), cover().design, verify, output_.progress());
    diagnose::name_files(result.findings, options_.site.file);
    json_ = nlohmann::json::array();
    for (const diagnose::Finding& f : result.findings) {
      json_.push_back(finding_json(cover().design, f));
      json_.back()["repair"] = diagnose::repair_steps(cover().design, f, arguments());
    }
    return std::move(result.findings);
  }
  // After a repair, a person presses only the modules that it concerned, not the whole skin.
  static bool asks_for(const diagnose::Finding* about, layout::ModuleId module) {
    return about == nullptr || about->module == module || about->other == module ||
           std::ranges::find(about->behind, module) != about->behind.end();
  }
  bool ask_for_press(layout::ModuleId module) {
    return ask(output_, fmt::format("press module {} after Enter.", design::number_of(cover().design, module))) ==
           Answer::kDone;
  }

  [[nodiscard]] const diagnose::Finding* next_of(const std::vector<diagnose::Finding>& findings) const {
    const auto open = [&](const diagnose::Finding& f) {
      return std::ranges::none_of(skipped_, [&](const diagnose::Finding& s) { return same(s, f); });
    };
    const auto found = std::ranges::find_if(findings, open);
    return found == findings.end() ? nullptr : &*found;
  }

  [[nodiscard]] std::string arguments() const {
    const robot::CoverConfig& c = cover();
    return options_.site.file + (c.name.empty() ? "" : " --cover " + c.name) +
           (options_.site.link.link.empty() ? "" : " --link " + options_.site.link.link);
  }

  // The program itself performs the steps after the manual work, from flashing on.
  Answer show(const diagnose::Finding& finding, std::size_t of) {
    std::vector<std::string> steps = diagnose::repair_steps(cover().design, finding, arguments());
    const auto ours = [](const std::string& s) {
      return s.starts_with("triskin flash") || s.starts_with("triskin verify") || s.starts_with("take everything off");
    };
    std::erase_if(steps, ours);
    output_.say(fmt::format("finding 1 of {}:", of));
    for (const std::string& line : finding_lines(finding, steps)) output_.say(line);
    if (finding.kind == diagnose::FindingKind::kStaleRest) return ask(output_, "Take everything off the skin.");
    if (steps.empty()) return ask(output_, "The tables are written next.");
    return ask(output_, "Fix this now.");
  }

  void flash_again() {
    open();
    deploy::FlashOptions flash;
    flash.recognise = true;
    flash.actuator = live_cover().actuator();
    try {
      (void)deploy::flash(bus(), cover().design, flash, output_.progress());
    } catch (const DeviceError& e) {
      output_.say(fmt::format("not flashed: {}", e.what()));
    }
  }
  std::vector<diagnose::Finding> check_again(const diagnose::Finding& mended) {
    if (mended.kind == diagnose::FindingKind::kStaleRest) {
      tare();
    } else {
      flash_again();
    }
    auto findings = check(&mended);
    if (std::ranges::any_of(findings, [&](const diagnose::Finding& f) { return same(f, mended); })) {
      output_.say("still there");
    } else {
      ++mended_;
      needs_tare_ = needs_tare_ || mended.kind != diagnose::FindingKind::kStaleRest;
      output_.say("mended");
    }
    return findings;
  }

  // Exchanged modules have other rest values. Only a skin without other findings is tared.
  void tare() {
    live_bus().find_controllers();
    live_bus().start({}, {});
    live_bus().tare();
    live_bus().finish();
    (void)live_cover().keep_rest();
    needs_tare_ = false;
    tared_ = true;
    output_.say("tared");
  }

  const Options& options_;
  Output& output_;
  std::unique_ptr<skin::LiveSkin> skin_;
  std::vector<diagnose::Finding> skipped_;
  nlohmann::json json_;
  int mended_ = 0;
  bool needs_tare_ = false, tared_ = false;
};

const Registration kRepair{{
    "repair",
    "lead through the findings of verify one at a time, and check again after each",
    "triskin repair forearm.json --link can:can0",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      add_site_options(app, options->site);
      app.add_flag("--touch", options->verify.touch,
                   "press every module in turn before the first repair, and again those it concerned (always on "
                   "simulated links)");
      app.add_flag("--no-touch", options->no_touch, "only ask, even on a simulated link");
      return [options](Output& output) { return Repair(*options, output).run(); };
    },
    Group::kHardware,
}};

}  // namespace
}  // namespace triskin::cli::repair_command
