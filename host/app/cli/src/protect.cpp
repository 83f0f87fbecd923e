// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "site_options.hpp"
#include "triskin/design/design.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::cli::protect_command {
namespace {

struct Options {
  SiteOptions site;
  int node = 0;
  bool release = false;
};

std::string silence_text(int node) {
  return node == 0 ? "no controller answers" : fmt::format("no controller answers at node address {}", node);
}

int run(const Options& options, Output& output) {
  std::mutex results;
  std::vector<std::string> missing;
  nlohmann::json controllers = nlohmann::json::array();
  on_each_bus(options.site, output, [&](const OpenBus& at) {
    const Answering found = find_controllers(at, options.node);
    for (const wire::NodeClaim& claim : found.claims) {
      session::Controller(at.bus, claim.node_address).protect_loader(!options.release);
      const std::lock_guard lock(results);
      output.say(fmt::format("{}controller {}: its loader {} from the next power-up on", at.prefix(),
                             claim.node_address, options.release ? "can be written" : "is write-protected"));
      controllers.push_back({{"serial", session::to_text(claim.unique_id)}, {"node_address", claim.node_address}});
    }
    if (found.claims.empty()) throw DeviceError(at.bus.nobody_answers(silence_text(options.node)));
    const std::lock_guard lock(results);
    for (const std::string& who : found.missing) {
      output.say(fmt::format("{}{} does not answer and was not reached; check power and cable", at.prefix(), who));
      missing.push_back(at.prefix() + who);
    }
  });
  output.result = {{"controllers", std::move(controllers)}, {"protected", !options.release}, {"missing", missing}};
  return missing.empty() ? 0 : 1;
}

const Registration kProtect{{
    "protect",
    "write-protect the loaders of controllers, or release them",
    "triskin protect --link can:can0",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("DESIGN", options->site.file, "design file, or robot file: all of its buses; or only --link");
      add_link_options(app, options->site.link);
      app.add_option("--node", options->node, "only the controller at this node address, 1 … 126")
          ->check(CLI::Range(1, 126));
      app.add_flag("--release", options->release, "remove the protection, so that a programmer can write the loader");
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kHardware,
}};

}  // namespace
}  // namespace triskin::cli::protect_command
