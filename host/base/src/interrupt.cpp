// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/interrupt.hpp"

#include <csignal>

namespace triskin {
namespace {

std::atomic<bool> requested = false;
std::atomic<int> caught = 0;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler writes it");

}  // namespace

std::atomic<bool>& interrupt_request() {
  return requested;
}

int interrupt_signal() {
  return caught;
}

void catch_interrupts() {
  struct sigaction action{};
  action.sa_handler = [](int number) {
    caught = number;
    requested = true;
  };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  (void)::sigaction(SIGINT, &action, nullptr);
  (void)::sigaction(SIGTERM, &action, nullptr);
  (void)::sigaction(SIGHUP, &action, nullptr);
}

}  // namespace triskin
