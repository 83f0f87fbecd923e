// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/interrupt.hpp"

#include <csignal>

namespace triskin {
namespace {

std::atomic<bool> requested = false;
std::atomic<int> caught = 0;
std::atomic<unsigned> seen = 0;  // Each signal number has one bit.
std::atomic<void (*)()> restore_terminal = nullptr;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free &&
                  std::atomic<void (*)()>::is_always_lock_free,
              "a signal handler uses them");

void take_signal(int number) {
  const unsigned bit = 1U << static_cast<unsigned>(number);
  if ((seen.fetch_or(bit) & bit) == 0) {
    caught = number;
    requested = true;
    return;
  }
  if (auto* restore = restore_terminal.load()) restore();
  (void)::signal(number, SIG_DFL);
  (void)::raise(number);
}

}  // namespace

std::atomic<bool>& interrupt_request() {
  return requested;
}

int interrupt_signal() {
  return caught;
}

void before_sudden_end(void (*restore)()) {
  restore_terminal = restore;
}

void catch_interrupts() {
  struct sigaction action{};
  action.sa_handler = &take_signal;
  (void)::sigaction(SIGINT, &action, nullptr);
  (void)::sigaction(SIGTERM, &action, nullptr);
  (void)::sigaction(SIGHUP, &action, nullptr);
}

}  // namespace triskin
