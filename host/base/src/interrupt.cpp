// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/host/interrupt.hpp"

#include <csignal>

namespace triskin {
namespace {

std::atomic<bool> requested = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler writes it");

}  // namespace

std::atomic<bool>& interrupt_request() {
  return requested;
}

void catch_interrupts() {
  struct sigaction action{};
  action.sa_handler = [](int) { requested = true; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  (void)::sigaction(SIGINT, &action, nullptr);
  (void)::sigaction(SIGTERM, &action, nullptr);
}

}  // namespace triskin
