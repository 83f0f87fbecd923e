// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <stdexcept>
#include <string>

namespace triskin {

/// Error that ends a command. The message names the thing, the place and the remedy.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  /// Process exit status of the command line: 2 unusable input, 3 device or link.
  [[nodiscard]] virtual int exit_status() const { return 2; }
};

/// Unusable arguments or input: file, line or place, and what to do. Nothing was written.
class InputError : public Error {
 public:
  using Error::Error;
};

/// A device or a link failed: device, operation, address and cause.
class DeviceError : public Error {
 public:
  using Error::Error;
  [[nodiscard]] int exit_status() const override { return 3; }
};

}  // namespace triskin
