// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/core/status.hpp"

namespace triskin::fw {

/// What answers on a line, whether the table knows it or not.
struct LineScan {
  std::uint8_t answers = 0;   ///< bit a: a chip acknowledges at address a
  std::uint8_t wrong_id = 0;  ///< bit a: and its device id is not an AD7147's
  bool stuck = false;
  bool done = false;
};

/// Reads the device id at each address of a line, one after another, on request. Pure: it names the address to ask
/// next and takes the answer; the caller makes the transfers.
class AddressScan {
 public:
  /// Forgets the last result; a scan is to begin.
  void request();
  /// A scan was requested and has not begun.
  [[nodiscard]] bool requested() const { return requested_; }
  /// Begins with address 0.
  void begin();
  /// Address to ask now, 0..3.
  [[nodiscard]] std::uint8_t address() const { return address_; }
  /// The transfer at address() ended with `transfer`; if that is kOk, `identity` says whose id was read. True: ask at
  /// address(), which is the next one. False: the scan is done.
  [[nodiscard]] bool answered(Status transfer, Status identity);
  /// The transfer was cut short, its answer does not count: the scan is to begin again.
  void interrupt() { requested_ = true; }
  /// The line was held low. `freed`: begin again, what answered until then is incomplete; otherwise the scan ends with
  /// the line stuck.
  void line_stuck(bool freed);
  /// What the last complete scan found.
  [[nodiscard]] const LineScan& result() const { return result_; }

 private:
  LineScan result_;
  std::uint8_t address_ = 0;
  bool requested_ = false;
};

}  // namespace triskin::fw
