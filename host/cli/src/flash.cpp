// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/device/flash.hpp"

#include <fmt/format.h>

#include <chrono>
#include <memory>

#include "triskin/cli/link_options.hpp"

namespace triskin::cli {
namespace {

struct Options {
  std::string design;
  device::LinkOptions link;
  device::FlashOptions flash;
  std::string route = "normal";
};

std::string what_happened(const device::FlashResult::Patch& p, bool dry_run) {
  const std::string address = p.new_address ? fmt::format(", node address {} -> {}", p.old_address, p.patch + 1) : "";
  if (p.equal && !p.written) return "equal, skipped";
  if (dry_run) return fmt::format("would write {} bytes{}", p.bytes, address);
  return fmt::format("{} bytes written and read back{}", p.bytes, address);
}

int run(Options options, Output& output) {
  const auto start = std::chrono::steady_clock::now();
  options.flash.route = device::parse_route(options.route);
  const model::Design design = model::read_design(options.design);
  const auto link = device::open_link(options.link, &design);
  device::Bus bus(*link);
  const device::FlashResult r = device::flash(bus, design, options.flash, output.progress());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  nlohmann::json patches = nlohmann::json::array();
  for (const auto& p : r.patches) {
    patches.push_back({{"patch", p.patch}, {"serial", p.serial}, {"node_address", p.patch + 1}, {"bytes", p.bytes},
                       {"equal", p.equal}, {"written", p.written}});
    output.say(fmt::format("patch {:3}  controller {}  {}", p.patch, p.serial, what_happened(p, options.flash.dry_run)));
  }
  output.result = {{"controllers", r.patches.size()}, {"bytes", r.bytes},     {"seconds", seconds},
                   {"skipped", r.skipped},            {"link_s", r.link_s},   {"dry_run", options.flash.dry_run},  {"route", options.route},
                   {"patches", std::move(patches)}};
  output.say(fmt::format("{} controllers, {} bytes written, {} skipped as equal; {:.2f} s", r.patches.size(), r.bytes, r.skipped, seconds));
  return 0;
}

const Registration kFlash{{
    "flash", "write the tables of a design into its controllers, and read them back", "triskin flash forearm.json --link sim",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("DESIGN", options->design, "design file")->required();
      add_link_options(app, options->link);
      app.add_flag("--dry-run", options->flash.dry_run, "say what would change, write nothing");
      app.add_option("--route", options->route, "normal; backup:MODULE or backup:MODULE-MODULE: the tree prepared for the failure of a module or of a joint")
          ->capture_default_str();
      app.add_flag("--force", options->flash.force, "write tables that are equal, too");
      return [options](Output& output) { return run(*options, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli
