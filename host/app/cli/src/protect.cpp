// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>

#include "command.hpp"
#include "link_options.hpp"
#include "triskin/design/design.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::cli::protect_command {
namespace {

struct Options {
  connect::LinkOptions link;
  int node = 0;
  bool release = false;
};

std::string silence_text(int node) {
  return node == 0 ? "no controller answers" : fmt::format("no controller answers at node address {}", node);
}

int run(const Options& options, Output& output) {
  const auto link = connect::open_link(options.link, nullptr);
  say_simulated(*link, output);
  session::Bus bus(*link);
  nlohmann::json controllers = nlohmann::json::array();
  for (const wire::NodeClaim& claim : bus.discover()) {
    if (options.node != 0 && claim.node_address != options.node) continue;
    session::Controller(bus, claim.node_address).protect_loader(!options.release);
    output.say(fmt::format("controller {}: its loader {} from the next power-up on", claim.node_address,
                           options.release ? "can be written" : "is write-protected"));
    controllers.push_back({{"serial", session::to_text(claim.unique_id)}, {"node_address", claim.node_address}});
  }
  if (controllers.empty()) throw DeviceError(bus.nobody_answers(silence_text(options.node)));
  output.result = {{"controllers", std::move(controllers)}, {"protected", !options.release}};
  return 0;
}

const Registration kProtect{{
    "protect",
    "write-protect the loaders of controllers, or release them",
    "triskin protect --link can:can0",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      add_link_options(app, options->link);
      app.add_option("--node", options->node, "only the controller at this node address, 1 … 126")
          ->check(CLI::Range(1, 126));
      app.add_flag("--release", options->release, "end the protection: a programmer can write the loader then");
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kHardware,
}};

}  // namespace
}  // namespace triskin::cli::protect_command
