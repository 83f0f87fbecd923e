// SPDX-License-Identifier: GPL-3.0-or-later
#include "table_writer.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace triskin::deploy {

// The answer to the activation may be lost although the table is active, so the bytes that are read back decide. If the
// request was lost, the whole procedure is repeated.
namespace {

// If the answer to the last step was lost, the table may be active all the same, so this is asked before trying again.
void write_with_retries(session::Controller& controller, Bytes image, const std::function<void(double)>& steps) {
  constexpr int kAttempts = 3;
  for (int attempt = 1;; ++attempt) {
    try {
      return controller.write_table(image, steps);
    } catch (const session::NoAnswer&) {
      if (controller.active_table().crc == crc32(image)) return;
      if (attempt == kAttempts) throw;
    }
  }
}

}  // namespace

bool holds_table(session::Controller& controller, Bytes image) {
  const wire::ActiveTable active = controller.active_table();
  return active.present() && active.crc == crc32(image) &&
         std::ranges::equal(controller.read_table(image.size()), image);
}

void write_and_compare(session::Controller& controller, session::Bus& bus, Bytes image,
                       const std::function<void(double)>& steps) {
  write_with_retries(controller, image, steps);
  const session::Bus::Uninterrupted guard(
      bus);  // After an interruption here, it would be unknown which table is active.
  const std::vector<std::uint8_t> back = controller.read_table(image.size());
  const auto [a, b] = std::mismatch(image.begin(), image.end(), back.begin(), back.end());
  if (a != image.end() || b != back.end()) {
    throw DeviceError(
        fmt::format("{}: controller {}: byte {} of the table reads back differently; its flash memory is damaged",
                    bus.link().name(), controller.node(), a - image.begin()));
  }
  controller.clear_faults();
}

}  // namespace triskin::deploy
