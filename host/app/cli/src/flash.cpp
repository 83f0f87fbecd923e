// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/deploy/flash.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "bus_report.hpp"
#include "calibration_options.hpp"
#include "flash_backup.hpp"
#include "flash_firmware.hpp"
#include "site_options.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/deploy/board_file.hpp"
#include "triskin/deploy/firmware_update.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/link/link_kind.hpp"
#include "triskin/session/controller_calibration.hpp"
#include "triskin/session/patch_offsets.hpp"
#include "triskin/skin/calibrate.hpp"

namespace triskin::cli::flash_command {
namespace {

struct Options {
  SiteOptions site;
  deploy::FlashOptions flash;
  std::string route = "normal";
  FirmwareOptions firmware;
  BackupOptions backup;
  std::vector<std::string> assign;
  std::string assign_file;
  bool by_serial = false, no_touch = false;
};

struct BusOutcome {
  const robot::BusConfig* bus = nullptr;
  std::vector<std::pair<const robot::CoverConfig*, deploy::FlashResult>> covers;
  std::set<wire::UniqueId> known;  // controllers that answered in any step
  // For each serial number, the revision of a calibration that was lost with an old table is listed.
  std::map<std::string, int> ended;
};

std::string what_happened(const deploy::FlashResult::Patch& p, bool dry_run) {
  const std::string address = p.new_address ? fmt::format(", node address {} -> {}", p.old_address, p.address) : "";
  if (!p.why.empty()) return "has not got its table: " + p.why;
  if (p.equal && !p.written) return "equal, skipped";
  if (dry_run && p.by == deploy::FoundBy::kNothing)
    return fmt::format("would write {}; which of the fresh controllers gets them shows when flashing",
                       counted(p.bytes, "byte"));
  if (dry_run) return fmt::format("would write {}{}", counted(p.bytes, "byte"), address);
  return fmt::format("{} written and read back{}", counted(p.bytes, "byte"), address);
}

bool settled(const session::PatchOffsets& patch) {
  return std::ranges::none_of(patch.offsets.rows(), [](const wire::ModuleOffsets& m) {
    return m.state == wire::OffsetState::kNone || m.state == wire::OffsetState::kSearching;
  });
}

// With a new table each controller searches the offsets of its converters and stores them. The command waits for this,
// so that later touches do not become rest values.
void wait_for_offsets(session::Bus& bus, const design::Design& design) {
  constexpr std::uint64_t kMaxWait_us = 1'500'000, kPause_us = 100'000;
  const std::uint64_t end_us = bus.now_us() + kMaxWait_us;
  while (bus.now_us() < end_us && !std::ranges::all_of(session::read_offsets(bus, design), settled))
    bus.listen(bus.now_us() + kPause_us);
}

// Flashes all covers of a bus in one pass. `outcome` contains the results, even when this throws.
void flash_covers(skin::LiveBus& live, const Options& options, const ProgressSink& progress, BusOutcome& outcome) {
  std::deque<session::Bus> buses;
  std::vector<deploy::FlashPart> parts;
  for (skin::LiveCover& cover : live.covers()) {
    deploy::FlashOptions flash = robot::flash_options(live.config(), cover.config(), options.flash);
    if (!options.no_touch) flash.actuator = cover.actuator();
    parts.push_back({&buses.emplace_back(live.link()), &cover.design(), std::move(flash),
                     progress_of(live.config(), cover.config(), progress)});
  }
  std::vector<deploy::FlashResult> results;
  const auto take = [&] {
    for (const session::Bus& bus : buses) outcome.known.insert(bus.known().begin(), bus.known().end());
    for (std::size_t k = 0; k < results.size(); ++k)
      outcome.covers.emplace_back(&live.covers()[k].config(), std::move(results[k]));
  };
  try {
    deploy::flash_together(parts, results);
  } catch (...) {
    take();
    throw;
  }
  take();
}

// The tables are complete by then, so a link that fails now has another message.
void wait_for_all_offsets(session::Bus& all, const BusOutcome& outcome) {
  try {
    for (const auto& [cover, r] : outcome.covers) {
      if (std::ranges::any_of(r.patches, &deploy::FlashResult::Patch::written)) wait_for_offsets(all, cover->design);
    }
  } catch (const link::Unreachable& e) {
    throw link::Unreachable(fmt::format(
        "{}; all tables are written and active; run triskin verify to see whether every converter has its offsets",
        e.what()));
  }
}

void flash_bus(skin::LiveBus& live, const Options& options, const ProgressSink& progress, BusOutcome& outcome) {
  outcome.bus = &live.config();
  session::Bus& all = live.bus();
  const std::map<std::string, int> before =
      options.flash.dry_run ? std::map<std::string, int>{} : session::kept_revisions(all);
  flash_covers(live, options, progress, outcome);
  if (!options.flash.dry_run) wait_for_all_offsets(all, outcome);
  outcome.known.insert(all.known().begin(), all.known().end());
  if (before.empty()) return;
  outcome.ended = before;
  for (const auto& [serial, revision] : session::kept_revisions(all)) outcome.ended.erase(serial);
}

nlohmann::json patch_row(const deploy::FlashResult::Patch& p) {
  return {{"patch", p.patch},          {"serial", p.serial}, {"found_by", deploy::kFoundByNames.name(p.by)},
          {"node_address", p.address}, {"bytes", p.bytes},   {"equal", p.equal},
          {"written", p.written},      {"why", p.why}};
}

nlohmann::json patch_rows(const robot::CoverConfig& cover, const deploy::FlashResult& r,
                          const std::map<std::string, int>& ended, bool dry_run, Output& output) {
  nlohmann::json patches = nlohmann::json::array();
  const skin::CalibrationStore calibrations;
  for (const auto& p : r.patches) {
    patches.push_back(patch_row(p));
    output.say(
        fmt::format("{}patch {:3}  controller {}  {}", prefix_of(cover), p.patch, p.serial, what_happened(p, dry_run)));
    if (const auto old = ended.find(p.serial); old != ended.end())
      output.say(
          fmt::format("{}controller {}  revision {} of its calibration ended with the old table, which was of "
                      "other modules: run triskin calibrate",
                      prefix_of(cover), p.serial, old->second));
    const auto kept = calibrations.read(p.serial);
    if (kept && (kept->design_id != cover.design.design_id || kept->patch != p.patch))
      output.say(prefix_of(cover) + note_of_other(*kept));
  }
  return patches;
}

void say_all(const std::vector<BusOutcome>& buses, const nlohmann::json& firmware, const Options& options,
             bool is_robot, double seconds, Output& output) {
  deploy::FlashResult sum;
  std::size_t controllers = 0, modules = 0;
  nlohmann::json covers = nlohmann::json::array();
  for (const BusOutcome& b : buses) {
    modules = 0;
    double link_s = 0.0;
    for (const auto& [cover, r] : b.covers) {
      nlohmann::json row = keys_of(*b.bus, *cover);
      row["patches"] = patch_rows(*cover, r, b.ended, options.flash.dry_run, output);
      covers.push_back(std::move(row));
      controllers += r.patches.size();
      sum.bytes += r.bytes;
      sum.skipped += r.skipped;
      link_s = std::max(link_s, r.link_s);  // All covers share one pass, so their times are not added.
      modules += cover->design.layout.modules.size();
    }
    sum.link_s = std::max(sum.link_s, link_s);  // Buses are served in parallel, so their times are not added.
  }
  output.result = {{"controllers", controllers}, {"bytes", sum.bytes},   {"seconds", seconds},
                   {"skipped", sum.skipped},     {"link_s", sum.link_s}, {"dry_run", options.flash.dry_run},
                   {"route", options.route},     {"firmware", firmware}};
  if (is_robot) {
    output.result["covers"] = std::move(covers);
  } else {
    output.result["patches"] = std::move(covers[0]["patches"]);
    report_bus(modules, output);
  }
  output.say(fmt::format("{}, {} written, {} skipped as equal; {:.2f} s", counted(controllers, "controller"),
                         counted(sum.bytes, "byte"), sum.skipped, seconds));
}

// Numbers of patches and modules refer to one cover.
void require_cover(const Options& options, const robot::Site& site) {
  const bool of_one = options.flash.patch >= 0 || !options.flash.assign.empty() || !options.assign_file.empty() ||
                      options.route != "normal";
  if (site.is_robot && of_one && options.site.cover.empty())
    throw InputError(
        "--patch, --assign, --assign-file and --route count patches and modules of one cover: say which with --cover");
}

// Reads the file of triskin identify. Names on the command line take precedence.
void add_board_file(Options& options, const robot::Site& site) {
  if (options.assign_file.empty()) return;
  const auto& covers = site.buses.at(0).covers;
  const auto cover = std::ranges::find_if(covers, [](const robot::CoverConfig& c) { return c.chosen; });
  if (cover == covers.end()) throw InputError("--assign-file: the cover has no controller on this bus");
  for (const auto& a : deploy::read_board_file(options.assign_file, cover->design).boards) {
    const bool named = std::ranges::any_of(
        options.flash.assign, [&](const auto& given) { return given.patch == a.patch || given.serial == a.serial; });
    if (!named) options.flash.assign.push_back(a);
  }
}

std::optional<deploy::FirmwarePackage> package_of(const Options& options) {
  if (options.firmware.file.empty()) return std::nullopt;
  if (link::is_usb(options.site.link.link))
    throw InputError("--firmware goes over CAN; by USB: dfu-util -d 1209:0001,1209:0002 -D FILE -R (docs/connect.md)");
  deploy::FirmwarePackage package = deploy::read_firmware(options.firmware.file);
  deploy::require_fit(package, options.firmware.update.hardware);  // before tables are written
  return package;
}

void require_backup_files(const BackupOptions& backup) {
  if (!backup.onto.empty() && backup.restore.empty()) throw InputError("--onto belongs to --restore");
  if (!backup.save.empty() && backup.save == backup.restore)
    throw InputError("--save and --restore name the same file, which would be lost; give two");
}

int run(Options options, Output& output) {
  const auto start = std::chrono::steady_clock::now();
  for (const std::string& text : options.assign) {
    const auto [patch, serial] = robot::parse_serial(text);
    options.flash.assign.push_back({patch, serial});
  }
  const std::optional<deploy::FirmwarePackage> firmware = package_of(options);
  skin::LiveSkin skin = open_skin(options.site, output);
  require_cover(options, skin.site());
  if (options.route != "normal")
    options.flash.route = session::parse_route(options.route, skin.site().buses.at(0).covers.at(0).design);
  add_board_file(options, skin.site());
  require_backup_files(options.backup);
  if (!options.backup.save.empty()) save_backup(skin, options.backup, output);
  if (!options.backup.restore.empty()) {
    restore_backup(skin, options.backup, options.flash, output);
    return 0;
  }
  options.flash.recognise = !options.by_serial;
  options.flash.say = say_aside;
  std::vector<BusOutcome> buses(skin.buses().size());
  const ProgressSink progress = output.progress();
  FirmwareReport updated;
  const auto say = [&] {
    std::erase_if(buses, [](const BusOutcome& b) { return b.covers.empty(); });
    say_all(buses, updated.rows, options, skin.site().is_robot,
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), output);
  };
  try {
    skin.on_each_bus([&](skin::LiveBus& bus) { flash_bus(bus, options, progress, buses[bus.index()]); });
    // The tables were written before, so all controllers have separate addresses by now.
    if (firmware) {
      std::set<wire::UniqueId> known;
      for (const BusOutcome& b : buses) known.insert(b.known.begin(), b.known.end());
      updated = flash_firmware(skin.links(), known, *firmware, options.firmware, options.flash, output);
    }
  } catch (const Error&) {
    if (buses.size() > 1) say();  // Reports the results of the other buses.
    throw;
  }
  say();
  return updated.complete ? 0 : 1;
}

const Registration kFlash{{
    "flash",
    "write the tables of a design into its controllers, and read them back",
    "triskin flash forearm.json --link sim",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      options->flash.wait_s = 20.0;
      add_site_options(app, options->site);
      add_firmware_options(app, options->firmware);
      add_backup_options(app, options->backup);
      app.add_option("--wait-s", options->flash.wait_s, "how long to wait for a cable that was pulled (0: end at once)")
          ->check(CLI::Range(0.0, 86400.0))
          ->capture_default_str();
      app.add_option("--per-wire", options->flash.per_wire,
                     "controllers served at once on one CAN bus (1: a bus analyser shows whole transfers)")
          ->check(CLI::Range(1, int{layout::kMaxNodes}))
          ->capture_default_str();
      app.add_flag("--dry-run", options->flash.dry_run, "show what would change; write nothing");
      app.add_option("--route", options->route,
                     "normal; backup:MODULE or backup:MODULE-MODULE: the tree prepared for the failure of a module or "
                     "of a joint")
          ->capture_default_str();
      app.add_option("--assign", options->assign,
                     "PATCH=SERIAL: this controller gets the patch, whatever it holds; may be repeated");
      app.add_option("--assign-file", options->assign_file,
                     "the same from a file that triskin identify wrote (docs/deploy.md)");
      app.add_flag(
          "--by-serial", options->by_serial,
          "give the patches to fresh controllers by ascending serial number (default: by the shapes of the patches)");
      app.add_flag("--no-touch", options->no_touch,
                   "on a simulated link: no virtual finger for patches that look alike");
      app.add_option("--patch", options->flash.patch, "only this patch; its controller is the only one on the link")
          ->check(CLI::Range(0, int{layout::kLastNode} - 1));
      app.add_flag("--take-over", options->flash.take_over, "overwrite the tables of other designs too");
      app.add_flag("--positive-input", options->flash.positive_input,
                   "electrodes at the converters' positive input, as on the installed iCub boards");
      app.add_flag("--force", options->flash.force, "write equal tables too");
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kHardware,
}};

}  // namespace
}  // namespace triskin::cli::flash_command
