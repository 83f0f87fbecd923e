// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>
#include <string>

#include "command.hpp"
#include "triskin/connect/attached.hpp"

namespace triskin::cli::list_command {
namespace {

int run(const std::string& root, Output& output) {
  nlohmann::json links = nlohmann::json::array();
  for (const connect::AttachedDevice& d : connect::attached_devices(root)) {
    output.say(fmt::format("{:32} {}", d.link, d.remark));
    links.push_back({{"link", d.link}, {"remark", d.remark}, {"usable", d.usable}});
  }
  if (links.empty()) output.say("nothing is attached: no CAN interface and no USB board; triskin doctor says more");
  output.result["links"] = std::move(links);
  return 0;
}

const Registration kList{{
    "list",
    "attached hardware: CAN interfaces and USB boards, as --link names them",
    "triskin list",
    [](CLI::App& app) -> Run {
      auto root = std::make_shared<std::string>("/");
      app.add_option("--root", *root, "look at the tree below this folder, as an image of another computer")
          ->check(CLI::ExistingDirectory);
      return [root](Output& output) { return run(*root, output); };
    },
    Group::kHardware,
}};

}  // namespace
}  // namespace triskin::cli::list_command
