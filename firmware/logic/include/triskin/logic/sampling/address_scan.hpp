// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/core/status.hpp"

namespace triskin::fw {

/// Chips that answer on a line, whether the table knows them or not.
struct LineScan {
  std::uint8_t answers = 0;   ///< Bit a says that a chip acknowledges at address a.
  std::uint8_t wrong_id = 0;  ///< Bit a says that this chip is not an AD7147 by its device id.
  bool stuck = false;
  bool done = false;
};

/// Reads the device id at each address of a line, one after another, on request. It contains no transfers: it names the
/// next address and receives the answer; the caller makes the transfers.
class AddressScan {
 public:
  /// Discards the last result and requests a scan.
  void request();
  /// Returns true if a scan was requested and has not started.
  [[nodiscard]] bool requested() const { return requested_; }
  /// Starts with address 0.
  void begin();
  /// Returns the present address, 0..3.
  [[nodiscard]] std::uint8_t address() const { return address_; }
  /// Reports that the transfer at address() ended with `transfer`; if that is kOk, `identity` says whose id was read.
  /// Returns true if the next address must be asked, false if the scan is complete.
  [[nodiscard]] bool answered(Status transfer, Status identity);
  /// Reports that the transfer was cut short, so its answer does not count and the scan must start again.
  void interrupt() { requested_ = true; }
  /// Reports that the line was held low. If `freed`, the scan starts again, because the answers so far are incomplete;
  /// otherwise it ends with the line stuck.
  void line_stuck(bool freed);
  /// Returns the result of the last complete scan.
  [[nodiscard]] const LineScan& result() const { return result_; }

 private:
  LineScan result_;
  std::uint8_t address_ = 0;
  bool requested_ = false;
};

}  // namespace triskin::fw
