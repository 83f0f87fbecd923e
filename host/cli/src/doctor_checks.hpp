// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "triskin/connect/attached.hpp"

namespace triskin::cli {

/// One thing that a working computer needs.
struct DoctorCheck {
  std::string name;
  bool ok = false;
  std::string found;   ///< It tells a person what was seen.
  std::string remedy;  ///< It is the command that mends it, or what to do by hand, and empty where all is well.
  bool needed = true;  ///< If false, something works less well without it, and the exit status does not say so.
};

/// A controller that answered.
struct AnsweringBoard {
  std::string link, serial, firmware;  ///< The firmware is written as "MAJOR.MINOR.PATCH".
};

/// A part of the program that a build may leave out.
struct OptionalPart {
  std::string name, package;
  bool is_there = false;
};

/// Everything that the checks read. A test replaces it by its own tree and answers.
struct Machine {
  std::filesystem::path root = "/";
  /// It returns the value of an environment variable, or nothing if it is not set.
  std::function<std::string(const std::string& name)> variable;
  std::function<bool(const std::string& program)> has_program;  ///< It returns true if the program is on the path.
  nlohmann::json interfaces = nlohmann::json::array();          ///< It is what `ip -json -details link show` prints.
  std::vector<AnsweringBoard> boards;  ///< These boards answer on the links that can be opened.
  std::vector<OptionalPart> parts;
  std::string program_version;
};

/// The rules by which an ordinary user may open boards on USB and HID.
[[nodiscard]] std::vector<DoctorCheck> check_rules(const Machine& machine);
/// Support of the kernel for CAN, loaded or to be loaded when it is needed.
[[nodiscard]] std::vector<DoctorCheck> check_kernel(const Machine& machine);
/// Each CAN interface: up, bit rate, FD, length of its queue, state of its controller.
[[nodiscard]] std::vector<DoctorCheck> check_interfaces(const Machine& machine);
/// What is attached: whether it may be opened, answers, and has the firmware of this program.
[[nodiscard]] std::vector<DoctorCheck> check_boards(const Machine& machine);
/// The environment of DDS, a browser, and parts that this build left out.
[[nodiscard]] std::vector<DoctorCheck> check_surroundings(const Machine& machine);

/// All of them, in this order. Cost: some reads of small files.
[[nodiscard]] std::vector<DoctorCheck> check_machine(const Machine& machine);

}  // namespace triskin::cli
