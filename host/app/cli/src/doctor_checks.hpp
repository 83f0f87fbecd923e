// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "triskin/connect/attached.hpp"

namespace triskin::cli {

/// A working computer has to meet this requirement.
struct DoctorCheck {
  std::string name;
  bool ok = false;
  std::string found;   ///< The text tells a person what was found.
  std::string remedy;  ///< The remedy is a command, or work to do by hand; it is empty if all is well.
  bool needed = true;  ///< False means that the requirement is optional and does not affect the exit status.
};

struct AnsweringBoard {
  std::string link, serial, firmware;  ///< The firmware is written as "MAJOR.MINOR.PATCH".
};

/// A build may leave this part of the program out.
struct OptionalPart {
  std::string name, package;
  bool is_there = false;
};

/// The checks read nothing but this. A test replaces it by its own file tree and answers.
struct Machine {
  std::filesystem::path root = "/";
  /// Returns the value of an environment variable, or nothing if it is not set.
  std::function<std::string(const std::string& name)> variable;
  /// The function returns true if the program is on the path.
  std::function<bool(const std::string& program)> has_program;
  nlohmann::json interfaces = nlohmann::json::array();  ///< The value is the output of `ip -json -details link show`.
  std::vector<AnsweringBoard> boards;                   ///< These boards answer on the links that can be opened.
  std::vector<OptionalPart> parts;
  std::string program_version;
};

/// Checks the rules that let an ordinary user open boards on USB and HID.
[[nodiscard]] std::vector<DoctorCheck> check_rules(const Machine& machine);
/// Checks that the kernel supports CAN, with modules that are loaded or can be loaded on demand.
[[nodiscard]] std::vector<DoctorCheck> check_kernel(const Machine& machine);
/// Checks each CAN interface: up, bit rate, FD, length of its queue, state of its controller.
[[nodiscard]] std::vector<DoctorCheck> check_interfaces(const Machine& machine);
/// Checks each attached device: whether it may be opened, answers, and has the firmware of this program.
[[nodiscard]] std::vector<DoctorCheck> check_boards(const Machine& machine);
/// Checks the environment of DDS, the sandbox of readers, the browser, and parts that this build left out.
[[nodiscard]] std::vector<DoctorCheck> check_surroundings(const Machine& machine);

/// Runs all checks, in this order. Cost: a few reads of small files.
[[nodiscard]] std::vector<DoctorCheck> check_machine(const Machine& machine);

}  // namespace triskin::cli
