// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <stdexcept>
#include <string>

namespace triskin {

/// Ends a command. The message names the thing, the place and the remedy.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  /// Returns the exit status of the command line: 2 for unusable input, 3 for a device, a link or a lack of resources.
  [[nodiscard]] virtual int exit_status() const { return 2; }
};

/// Reports unusable arguments or input: file, line or place, and what to do. No output was written.
class InputError : public Error {
 public:
  using Error::Error;
};

/// Reports that a device or a link failed: device, operation, address and cause.
class DeviceError : public Error {
 public:
  using Error::Error;
  [[nodiscard]] int exit_status() const override { return 3; }
};

/// Reports that the computer, or a limit of the shell, has no more of something: which, and how to get more.
class ResourceError : public Error {
 public:
  using Error::Error;
  [[nodiscard]] int exit_status() const override { return 3; }
};

}  // namespace triskin
