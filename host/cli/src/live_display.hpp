// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "triskin/cli/command.hpp"
#include "triskin/session/stream_report.hpp"
#include "triskin/skin/live_monitor.hpp"
#include "triskin/skin/skin_contacts.hpp"

namespace triskin::cli {

struct LiveState {
  double time_s = 0.0;
  std::uint64_t frames = 0, lost = 0;
  std::string note;  ///< The line is for a person and may be empty.
  /// Of the controllers' latest samples, the largest error bound of their time is given.
  std::optional<std::uint32_t> error_us{};
  std::vector<device::AdoptedCounts> adopted{};  ///< A controller of another patch reads these modules now.
};

/// Shows a skin while its samples arrive: as a picture on a terminal, as a line for each change elsewhere, as an object
/// per line with --json.
class LiveDisplay {
 public:
  enum class Wish { kNothing, kTare, kEnd };
  virtual ~LiveDisplay() = default;
  /// Shows the present state; returns the request since the last call.
  virtual Wish show(device::LiveMonitor& monitor, const LiveState& state) = 0;
};

/// Makes the display for an output. `design` and `output` must outlive it.
[[nodiscard]] std::unique_ptr<LiveDisplay> make_display(const design::Design& design, const Output& output);
/// Describes the place of a taxel and the pressure on it, in kPa if the monitor is calibrated, otherwise in counts.
[[nodiscard]] std::string place_text(const device::LiveMonitor& monitor, const device::PressedTaxel& taxel);
/// Describes a contact's place, force and area with deviations; without a calibration the force is left out.
[[nodiscard]] std::string contact_text(const device::SkinContact& contact);
/// Writes the keys "time_s", "frames", "lost", "pressed", "contacts", "unit", with a calibration "force_n",
/// "net_force_n" and "net_torque_nmm", and, if they are known, "time_error_us" and "adopted" of a line.
[[nodiscard]] nlohmann::json to_json(const device::LiveMonitor& monitor, const LiveState& state);

}  // namespace triskin::cli
