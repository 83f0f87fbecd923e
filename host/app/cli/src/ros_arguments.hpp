// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

namespace triskin::cli {

/// What stood after --ros-args on the command line: its words begin with "-" as ours do, and are not for CLI11.
inline std::vector<std::string>& ros_arguments() {
  static std::vector<std::string> arguments;
  return arguments;
}

/// Of `triskin bridge … --ros-args …` the words behind are moved to ros_arguments(); returns how many words remain.
inline int take_ros_arguments(int argc, char** argv) {
  if (argc < 2 || std::string(argv[1]) != "bridge") return argc;
  for (int k = 2; k < argc; ++k) {
    if (std::string(argv[k]) != "--ros-args") continue;
    ros_arguments().assign(argv + k + 1, argv + argc);
    return k + 1;
  }
  return argc;
}

}  // namespace triskin::cli
