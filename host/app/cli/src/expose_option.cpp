// SPDX-License-Identifier: GPL-3.0-or-later
#include "expose_option.hpp"

#include <fmt/format.h>

#include "command.hpp"

namespace triskin::cli {

void add_expose_option(CLI::App& app, bool& expose) {
  app.add_flag(
      "--expose", expose,
      "with --listen: allow an address that other computers reach; there is no password, so whoever reaches it "
      "may read, press and flash the simulated skin");
}

hardware::Reach reach_of(bool expose) {
  return expose ? hardware::Reach::kOtherComputers : hardware::Reach::kThisComputer;
}

void warn_exposed(const std::string& link) {
  say_aside(
      fmt::format("WARNING: {} can be reached from other computers and has no password: whoever reaches it may read, "
                  "press and flash this skin",
                  link));
}

}  // namespace triskin::cli
