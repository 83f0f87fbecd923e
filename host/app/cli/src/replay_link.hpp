// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "command.hpp"

namespace triskin::cli {

struct ReplayLinkOptions {
  std::string file;     ///< The recording is a file (.mcap).
  std::string listen;   ///< The text has the syntax of --listen of simulate.
  double speed = 1.0;   ///< The speed must be positive.
  bool loop = false;    ///< True restarts the recording at its end, until a person stops it.
  bool expose = false;  ///< True allows `listen` to be an address that other computers can reach.
};

/// Serves simulated controllers whose taxels read the recorded values, so that every client reads them over a link.
/// Playing starts when the first client sends a request. Sample numbers and times are those of the simulation; modules
/// that are not in the recording are absent. Returns the exit status. Throws InputError, DeviceError. Memory: bounded.
int replay_into_link(const ReplayLinkOptions& options, Output& output);

}  // namespace triskin::cli
