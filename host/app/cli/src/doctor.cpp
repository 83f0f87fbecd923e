// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

#include "command.hpp"
#include "doctor_checks.hpp"
#include "triskin/base/error.hpp"
#include "triskin/bridge/dds.hpp"
#include "triskin/connect/open_link.hpp"
#include "triskin/hdf5/taxel_table.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/firmware_version.hpp"

namespace triskin::cli::doctor_command {
namespace {

struct Options {
  std::string root;
};

std::string variable(const std::string& name) {
  const char* value = std::getenv(name.c_str());
  return value == nullptr ? "" : value;
}

bool has_program(const std::string& name) {
  std::istringstream folders(variable("PATH"));
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((std::filesystem::path(folder) / name).c_str(), X_OK) == 0) return true;
  return false;
}

nlohmann::json array_in(const std::string& text) {
  nlohmann::json list = nlohmann::json::parse(text, nullptr, false);
  return list.is_array() ? list : nlohmann::json::array();
}

// The kernel reports bit rates and error counters only by netlink, which ip reads.
std::string interfaces_text() {
  std::FILE* pipe = ::popen("ip -json -details link show 2>/dev/null", "r");
  if (pipe == nullptr) return "";
  std::string text;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
  ::pclose(pipe);
  return text;
}

std::vector<AnsweringBoard> boards_on(const std::string& link_name) {
  std::vector<AnsweringBoard> boards;
  try {
    connect::LinkOptions options;
    options.link = link_name;
    const auto link = connect::open_link(options, nullptr);
    session::Bus bus(*link);
    for (const wire::NodeClaim& claim : bus.discover()) {
      const auto hello = session::Controller(bus, claim.node_address).hello();
      boards.push_back(
          {link_name, session::to_text(claim.unique_id), session::firmware_version_text(hello.firmware_version)});
    }
  } catch (const Error&) {
    // A link that fails has no answering board, which the check reports.
  }
  return boards;
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

// A file tree that stands for a computer has the answers of ip and of the boards in two files.
void ask_tree(Machine& machine) {
  machine.interfaces = array_in(text_of(machine.root / "ip.json"));
  for (const auto& b : array_in(text_of(machine.root / "boards.json")))
    machine.boards.push_back({b.value("link", ""), b.value("serial", ""), b.value("firmware", "")});
  machine.has_program = [root = machine.root](const std::string& name) {
    return std::filesystem::exists(root / "usr/bin" / name);
  };
}

void ask_computer(Machine& machine) {
  machine.interfaces = array_in(interfaces_text());
  machine.has_program = has_program;
  for (const connect::AttachedDevice& d : connect::attached_devices())
    if (d.usable)
      for (AnsweringBoard& board : boards_on(d.link)) machine.boards.push_back(std::move(board));
}

Machine machine_of(const Options& options) {
  Machine machine;
  machine.program_version = TRISKIN_VERSION;
  machine.variable = variable;
  machine.parts = {{"DDS", "libfastrtps-dev", bridge::dds_available()}, {"HDF5", "libhdf5-dev", hdf5::can_write()}};
  if (options.root.empty()) {
    ask_computer(machine);
  } else {
    machine.root = options.root;
    ask_tree(machine);
  }
  return machine;
}

int run(const Options& options, Output& output) {
  const auto checks = check_machine(machine_of(options));
  nlohmann::json list = nlohmann::json::array();
  for (const DoctorCheck& c : checks) {
    list.push_back({{"name", c.name}, {"ok", c.ok}, {"remedy", c.remedy}, {"found", c.found}, {"needed", c.needed}});
    output.say(fmt::format("{:7} {}: {}", c.ok ? "ok" : c.needed ? "missing" : "without", c.name, c.found));
    if (!c.ok) output.say("        " + c.remedy);
  }
  output.result["checks"] = std::move(list);
  return std::ranges::any_of(checks, [](const DoctorCheck& c) { return c.needed && !c.ok; }) ? 1 : 0;
}

const Registration kDoctor{{
    "doctor",
    "check this computer for skin hardware: what is missing, and the command that adds it",
    "triskin doctor",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option(
             "--root", options->root,
             "look at the tree below this folder, as an image of another computer: its /sys, /proc, /etc, /dev, "
             "/lib; ip.json and boards.json hold what ip and the boards say")
          ->check(CLI::ExistingDirectory);
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kHardware,
}};

}  // namespace
}  // namespace triskin::cli::doctor_command
