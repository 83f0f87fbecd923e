// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/jobs/flash.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>

#include "triskin/cli/bus_report.hpp"
#include "triskin/cli/link_options.hpp"
#include "triskin/jobs/firmware_update.hpp"
#include "triskin/jobs/offset_report.hpp"
#include "triskin/layout/module.hpp"

namespace triskin::cli {
namespace {

struct Options {
  std::string design;
  device::LinkOptions link;
  device::FlashOptions flash;
  std::string route = "normal";
  std::string firmware;
  std::vector<std::string> assign;
};

// PATCH=SERIAL, as triskin discover shows the serial number.
device::FlashOptions::Assignment parse_assignment(const std::string& text) {
  const std::size_t at = text.find('=');
  const std::string patch = text.substr(0, at);
  std::string serial = at == std::string::npos ? "" : text.substr(at + 1);
  std::ranges::transform(serial, serial.begin(),
                         [](char c) { return c >= 'a' && c <= 'f' ? static_cast<char>(c - 'a' + 'A') : c; });
  if (patch.empty() || patch.size() > 6 || patch.find_first_not_of("0123456789") != std::string::npos ||
      serial.size() != 24 || serial.find_first_not_of("0123456789ABCDEF") != std::string::npos) {
    throw InputError(fmt::format(
        "--assign {}: give PATCH=SERIAL, where SERIAL has 24 hexadecimal digits, as triskin discover shows them",
        text));
  }
  return {std::stoi(patch), serial};
}

// Controllers have addresses of their own by now: the tables were written before.
nlohmann::json update_all(device::Bus& bus, const device::FirmwarePackage& package, const Options& options,
                          Output& output) {
  nlohmann::json rows = nlohmann::json::array();
  const ProgressSink bars = output.progress();
  for (const wire::NodeClaim& claim : bus.discover()) {
    const int part = static_cast<int>(rows.size());
    const ProgressSink bar = [&](const Progress& p) { report(bars, p.stage, p.fraction, p.detail, part); };
    const device::FirmwareResult r = device::update_firmware(bus, claim, package, options.flash, bar);
    rows.push_back({{"serial", r.serial}, {"equal", r.equal}, {"slot", r.slot}, {"bytes", r.bytes}});
    output.say(fmt::format("controller {}  firmware {}", r.serial,
                           r.bytes != 0
                               ? fmt::format("{} bytes written, slot {} runs", r.bytes, r.slot == 0 ? 'A' : 'B')
                           : r.equal ? std::string("equal, skipped")
                                     : std::string("would be written")));
  }
  return rows;
}

std::string what_happened(const device::FlashResult::Patch& p, bool dry_run) {
  const std::string address = p.new_address ? fmt::format(", node address {} -> {}", p.old_address, p.patch + 1) : "";
  if (p.equal && !p.written) return "equal, skipped";
  if (dry_run) return fmt::format("would write {} bytes{}", p.bytes, address);
  return fmt::format("{} bytes written and read back{}", p.bytes, address);
}

bool settled(const device::PatchOffsets& patch) {
  return std::ranges::none_of(patch.offsets.rows(), [](const wire::ModuleOffsets& m) {
    return m.state == wire::OffsetState::kNone || m.state == wire::OffsetState::kSearching;
  });
}

// With a new table each controller looks for the offsets of its converters, and keeps them. That is over before the
// command ends, so that what touches the skin later is not taken for its rest.
void wait_for_offsets(device::Bus& bus, const design::Design& design) {
  constexpr std::uint64_t kMost_us = 1'500'000, kPause_us = 100'000;
  const std::uint64_t end_us = bus.now_us() + kMost_us;
  while (bus.now_us() < end_us && !std::ranges::all_of(device::read_offsets(bus, design), settled))
    bus.listen(bus.now_us() + kPause_us);
}

int run(Options options, Output& output) {
  const auto start = std::chrono::steady_clock::now();
  options.flash.route = device::parse_route(options.route);
  for (const std::string& text : options.assign) options.flash.assign.push_back(parse_assignment(text));
  const design::Design design = design::read_intact_design(options.design);
  std::optional<device::FirmwarePackage> firmware;
  if (!options.firmware.empty()) {
    if (options.link.link.starts_with("hid") || options.link.link.starts_with("usb")) {
      throw InputError("--firmware goes over CAN; over USB: dfu-util -D FILE (docs/wires.md)");
    }
    firmware = device::read_firmware(options.firmware);
  }
  const auto link = device::open_link(options.link, &design);
  device::Bus bus(*link);
  options.flash.say = [&](const std::string& text) { std::fputs(("triskin: " + text + "\n").c_str(), stderr); };
  const device::FlashResult r = device::flash(bus, design, options.flash, output.progress());
  const bool any_written = std::ranges::any_of(r.patches, &device::FlashResult::Patch::written);
  if (any_written && !options.flash.dry_run) wait_for_offsets(bus, design);
  nlohmann::json updated = nlohmann::json::array();
  if (firmware) updated = update_all(bus, *firmware, options, output);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  nlohmann::json patches = nlohmann::json::array();
  for (const auto& p : r.patches) {
    patches.push_back({{"patch", p.patch},
                       {"serial", p.serial},
                       {"node_address", p.patch + 1},
                       {"bytes", p.bytes},
                       {"equal", p.equal},
                       {"written", p.written}});
    output.say(
        fmt::format("patch {:3}  controller {}  {}", p.patch, p.serial, what_happened(p, options.flash.dry_run)));
  }
  output.result = {{"controllers", r.patches.size()},
                   {"bytes", r.bytes},
                   {"seconds", seconds},
                   {"skipped", r.skipped},
                   {"link_s", r.link_s},
                   {"dry_run", options.flash.dry_run},
                   {"route", options.route},
                   {"patches", std::move(patches)},
                   {"firmware", std::move(updated)}};
  report_bus(design.layout.modules.size(), output);
  output.say(fmt::format("{} controllers, {} bytes written, {} skipped as equal; {:.2f} s", r.patches.size(), r.bytes,
                         r.skipped, seconds));
  return 0;
}

const Registration kFlash{{
    "flash",
    "write the tables of a design into its controllers, and read them back",
    "triskin flash forearm.json --link sim",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      options->flash.wait_s = 20.0;
      app.add_option("DESIGN", options->design, "design file")->required();
      add_link_options(app, options->link);
      app.add_option("--firmware", options->firmware,
                     "firmware package for every controller on the link, over CAN, one after the other")
          ->check(CLI::ExistingFile);
      app.add_option("--wait-s", options->flash.wait_s,
                     "how long to wait for a cable that was pulled meanwhile, and then go on; 0: end at once")
          ->check(CLI::Range(0.0, 86400.0))
          ->capture_default_str();
      app.add_option("--per-wire", options->flash.per_wire,
                     "controllers served at once on one CAN bus; on different wires all are")
          ->check(CLI::Range(1, int{layout::kMaxNodes}))
          ->capture_default_str();
      app.add_flag("--dry-run", options->flash.dry_run, "say what would change, write nothing");
      app.add_option("--route", options->route,
                     "normal; backup:MODULE or backup:MODULE-MODULE: the tree prepared for the failure of a module or "
                     "of a joint")
          ->capture_default_str();
      app.add_option("--assign", options->assign,
                     "PATCH=SERIAL: the controller with this serial number serves the patch, whatever it holds; may be "
                     "given several times");
      app.add_option("--patch", options->flash.patch, "this patch alone, with its one controller on the link")
          ->check(CLI::Range(0, int{layout::kLastNode} - 1));
      app.add_flag("--take-over", options->flash.take_over,
                   "take controllers that hold a table of another design, too");
      app.add_flag("--positive-input", options->flash.positive_input,
                   "the electrodes hang on the converters' positive input, as on the installed iCub boards");
      app.add_flag("--force", options->flash.force, "write tables that are equal, too");
      return [options](Output& output) { return run(*options, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli
