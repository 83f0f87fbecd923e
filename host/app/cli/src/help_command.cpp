// SPDX-License-Identifier: GPL-3.0-or-later
#include "help_command.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <string>

#include "did_you_mean.hpp"

namespace triskin::cli {
namespace {

constexpr const char* kLinks = R"(Where the controllers are: --link LINK of every device command

  can:IFACE         a CAN interface of this computer: can:can0
  usb, usb:SERIAL   boards on USB; one alone by its serial number
  hid, hid:SERIAL   the same through HID, which needs no driver
  sim               simulated in this process; keeps its flash between commands
  sim-usb           the same, each board a device on a USB hub
  sim:HOST:PORT     simulated by triskin simulate --listen HOST:PORT

Several real links are joined by commas: --link can:can0,can:can1
Without --link a robot file names its links; for a design the environment
variable TRISKIN_LINK does. --link sim or sim:HOST:PORT serves all buses of a
robot file. Nothing is simulated unless it is asked for: by a link sim, or by
--scene, --switched or --board-seed.
triskin list shows what is attached; triskin doctor says what is missing.
)";

int print(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  return 0;
}

}  // namespace

const CLI::App* find_command(const CLI::App& program, const std::string& name) {
  const auto found = program.get_subcommands([&](const CLI::App* c) { return c->get_name() == name; });
  return found.empty() ? nullptr : found.front();
}

std::optional<int> answer_help(const CLI::App& program, int argc, const char* const* argv) {
  if (argc < 2 || std::string(argv[1]) != "help") return std::nullopt;
  if (argc == 2) return print(program.help());
  const std::string topic = argv[2];
  if (topic == "links") return print(kLinks);
  if (const CLI::App* command = find_command(program, topic)) return print(command->help(program.get_name()));
  const char* const asked[] = {argv[0], argv[2]};
  const std::string question = did_you_mean(program, 2, asked, true);
  std::fputs(fmt::format("triskin: there is no command {}{}\n", topic, question.empty() ? "" : "; " + question).c_str(),
             stderr);
  return 2;
}

}  // namespace triskin::cli
