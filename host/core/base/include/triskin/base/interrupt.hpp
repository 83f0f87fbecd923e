// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <string>

#include "triskin/base/error.hpp"

namespace triskin {

/// Reports that a person ended the command (Ctrl-C). The work under way ended in a safe state; the message says what
/// was done.
class Cancelled : public Error {
 public:
  using Error::Error;
  [[nodiscard]] int exit_status() const override { return 3; }
};

/// Makes the first SIGINT, SIGTERM or SIGHUP only set interrupt_request(); a second one then ends the process at once.
void catch_interrupts();
/// A second signal calls this function before it ends the process, for example to restore the terminal; nullptr calls
/// nothing. The function may use only what a signal handler may use.
void before_sudden_end(void (*restore)());
/// Number of the signal that was caught; 0: none. Lock-free.
[[nodiscard]] int interrupt_signal();
/// Becomes true when the process was asked to end. Long work reads it at points where it can stop safely. Lock-free;
/// tests may set it.
[[nodiscard]] std::atomic<bool>& interrupt_request();

}  // namespace triskin
