// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/deploy/identify.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "site_options.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/files.hpp"
#include "triskin/deploy/board_file.hpp"
#include "triskin/layout/module.hpp"

namespace triskin::cli::identify_command {
namespace {

struct Options {
  SiteOptions site;
  deploy::IdentifyOptions identify;
  std::string output;
  bool by_hand = false, finger = false;
};

constexpr double kDefaultLimit_s = 60.0;

void tell_person(const std::string& text) {
  say_aside(text);
}

std::string how(deploy::FoundBy by) {
  switch (by) {
    case deploy::FoundBy::kShape:
      return "by the shape of its patch";
    case deploy::FoundBy::kOnly:
      return "the only one left";
    default:
      return "felt the touch";
  }
}

// Saves each result immediately, so that Ctrl-C loses nothing.
class Notes {
 public:
  Notes(std::string path, const design::Design& design) : path_(std::move(path)) {
    file_.design_id = design.design_id;
    if (!path_.empty() && path_ != "-" && std::filesystem::exists(path_))
      file_ = deploy::read_board_file(path_, design);
  }
  // A controller serves only one patch, so a former entry is replaced.
  void add(const deploy::IdentifiedBoard& found) {
    std::erase_if(file_.boards, [&](const auto& a) { return a.patch == found.patch || a.serial == found.serial; });
    file_.boards.push_back({found.patch, found.serial});
    std::ranges::sort(file_.boards, {}, &deploy::FlashOptions::Assignment::patch);
    if (!path_.empty() && path_ != "-") write_output(path_, deploy::board_file_text(file_));
  }
  void end() const {
    if (path_ == "-") write_output(path_, deploy::board_file_text(file_));
  }

 private:
  std::string path_;
  deploy::BoardFile file_;
};

int conclude(const std::vector<deploy::IdentifiedBoard>& boards, const Options& options, Output& output) {
  nlohmann::json rows = nlohmann::json::array();
  std::vector<layout::PatchIndex> missing;
  for (const deploy::IdentifiedBoard& b : boards) {
    if (b.serial.empty()) missing.push_back(b.patch);
    rows.push_back({{"patch", b.patch},
                    {"serial", b.serial.empty() ? nlohmann::json(nullptr) : nlohmann::json(b.serial)},
                    {"found_by", deploy::kFoundByNames.name(b.by)}});
  }
  output.result = {{"boards", std::move(rows)}, {"missing", missing}};
  if (!options.output.empty()) output.result["file"] = options.output;
  output.say(fmt::format("{} of {} have their controller{}", boards.size() - missing.size(),
                         counted(boards.size(), "patch"),
                         options.output.empty() || options.output == "-" ? "" : "; written to " + options.output));
  if (!missing.empty())
    output.say(
        fmt::format("no touch of {} {} was felt within {:g} s: the patch is dead, its controller is not connected, or "
                    "another patch was touched",
                    noun_after(missing.size() == 1, "patch"), fmt::join(missing, ", "), options.identify.limit_s));
  return missing.empty() ? 0 : 1;
}

void ask_for_touch(int patch, double limit_s, bool is_simulated) {
  tell_person(fmt::format("press any module of patch {} now (within {:g} s){}", patch, limit_s,
                          is_simulated ? "; with --finger the simulation does" : ""));
}

int run(Options options, Output& output) {
  const skin::LiveSkin skin = open_skin(options.site, output);
  skin::LiveCover& cover = one_cover(skin, "identify");
  Notes notes(options.output, cover.design());
  options.identify.say = tell_person;
  // Contacts in a scene act like fingers, so the program presses only without a scene.
  const bool own = link::is_in_process(options.site.link.link) && options.site.link.scene.empty();
  if (options.finger || (own && !options.by_hand)) options.identify.actuator = cover.actuator();
  options.identify.ask = [&](layout::PatchIndex patch) {
    ask_for_touch(patch, options.identify.limit_s, output.simulated() && options.site.link.scene.empty());
  };
  const auto boards = deploy::identify(
      skin.buses().front()->bus(), cover.design(), options.identify, [&](const deploy::IdentifiedBoard& found) {
        notes.add(found);
        output.say(fmt::format("patch {:3}  controller {}  {}", found.patch, found.serial, how(found.by)));
      });
  notes.end();
  return conclude(boards, options, output);
}

const Registration kIdentify{{
    "identify",
    "find out which controller serves which patch: by its shape, or by a touch",
    "triskin identify forearm.json --link sim -o boards.json",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      options->identify.limit_s = kDefaultLimit_s;
      add_site_options(app, options->site);
      app.add_option("--patch", options->identify.patch, "ask for this patch only, even if its shape identifies it")
          ->check(CLI::Range(0, int{layout::kLastNode} - 1));
      app.add_option("-o,--output", options->output,
                     "assignment file for triskin flash --assign-file; an existing file for this design is extended");
      app.add_option("--limit-s", options->identify.limit_s, "time limit of each touch")
          ->check(CLI::Range(0.1, 3600.0))
          ->capture_default_str();
      app.add_flag("--by-hand", options->by_hand,
                   "wait for touches on --link sim too, where normally a virtual finger presses");
      app.add_flag("--finger", options->finger, "let the virtual finger press on a served simulation too")
          ->excludes("--by-hand");
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kHardware,
}};

}  // namespace
}  // namespace triskin::cli::identify_command
