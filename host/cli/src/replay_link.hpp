// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/cli/command.hpp"

namespace triskin::cli {

/// How a recording is played into a link.
struct ReplayLinkOptions {
  std::string file;     ///< It is a recording (.mcap).
  std::string listen;   ///< It has the syntax of --listen of simulate.
  double speed = 1.0;   ///< It must be positive.
  bool loop = false;    ///< It starts anew at the end, until a person stops it.
  bool expose = false;  ///< `listen` may be an address that other computers reach
};

/// Serves simulated controllers whose taxels read what the recording holds, so that every client reads it over a link.
/// It begins when the first client asks something. Sample numbers and times are those of the simulation; modules that
/// the recording never heard are absent. Returns the exit status. Throws InputError, DeviceError. Memory: bounded.
int replay_into_link(const ReplayLinkOptions& options, Output& output);

}  // namespace triskin::cli
