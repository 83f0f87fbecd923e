// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "triskin/hardware/tcp_link.hpp"
#include "triskin/scenario/running_skin.hpp"

namespace triskin::scenario {

/// Another simulator touches this simulated skin. Step by step the skin receives the contacts and their strength, and
/// returns what the controllers send during the step (docs/simulation.md). Time is that of the other simulator. Not
/// thread-safe.
class ContactStream {
 public:
  static constexpr std::size_t kMaxLine_bytes = 1'000'000, kMaxContacts = 1'000;
  static constexpr double kMaxStep_s = 10.0;

  /// Flashes and starts the skin of the scene. Throws as RunningSkin.
  explicit ContactStream(hardware::Scene scene);
  ~ContactStream();
  ContactStream(const ContactStream&) = delete;
  ContactStream& operator=(const ContactStream&) = delete;

  /// Returns the first line for a client: JSON with format, version, design, modules and the time of the skin.
  [[nodiscard]] std::string greeting() const;
  /// Performs a step, given as one JSON object with the contacts and the time until which they last. Returns the
  /// answer, one JSON object without a line break: time, frames, samples, and how many contacts were on other bodies or
  /// felt by no taxel. Throws InputError that says what is wrong with the line, which then has no effect.
  [[nodiscard]] std::string take(const std::string& line);
  [[nodiscard]] double time_s() const;

 private:
  struct Answer;
  std::unique_ptr<Answer> answer_;
  std::unique_ptr<RunningSkin> skin_;
  std::vector<int> touches_;
};

/// Serves a stream at `at` (port 0 uses a free one), one client after the other, until `stop` is set or `seconds` of
/// wall time have passed (0: no limit). A rejected line is answered by {"error": …}, and the client is disconnected.
/// `listening` is called once with the port. Throws InputError for an address that other computers could reach,
/// DeviceError when the address cannot be used.
void serve_contacts(ContactStream& stream, const hardware::HostPort& at, const std::atomic<bool>& stop, double seconds,
                    const std::function<void(int port)>& listening);

}  // namespace triskin::scenario
