// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command.hpp"
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
  std::vector<session::AdoptedCounts> adopted{};  ///< A controller of another patch reads these modules now.
};

/// Decides when a line may say which taxels do not rest: when that begins, and once in kHeartbeat_s while it lasts.
class OffRestNotice {
 public:
  /// Whoever reads a pipe sees in this period that the skin is alive while nobody touches it.
  static constexpr double kHeartbeat_s = 5.0;
  /// Returns the sentence that is due at this time of the run, or nothing.
  [[nodiscard]] std::string due(const skin::LiveMonitor& monitor, double time_s);

 private:
  double said_s_ = 0.0;
  bool is_off_rest_ = false;
};

/// Shows a skin while its samples arrive: as a picture on a terminal, as a line for each change elsewhere, as an object
/// per line with --json.
class LiveDisplay {
 public:
  enum class Wish { kNothing, kTare, kEnd };
  virtual ~LiveDisplay() = default;
  /// Shows the present state; returns the request since the last call.
  virtual Wish show(skin::LiveMonitor& monitor, const LiveState& state) = 0;
};

/// Makes the display for an output. `design` and `output` must outlive it.
[[nodiscard]] std::unique_ptr<LiveDisplay> make_display(const design::Design& design, const Output& output);
/// Describes the place of a taxel and the pressure on it, in kPa if the monitor is calibrated, otherwise in counts.
[[nodiscard]] std::string place_text(const skin::LiveMonitor& monitor, const skin::PressedTaxel& taxel);
/// " and 6 more taxels"; empty for 0.
[[nodiscard]] std::string more_taxels(std::size_t number);
/// Describes a contact's place, force and area with deviations; without a calibration the force is left out. Says
/// when a taxel of it is pressed more than the calibration covers.
[[nodiscard]] std::string contact_text(const design::Design& design, const skin::SkinContact& contact,
                                       const design::SkinCalibration& calibration);
/// Writes the keys "taxels" (the number) and "modules".
[[nodiscard]] nlohmann::json to_json(const design::OffRest& off);
/// Writes the keys "time_s", "frames", "lost", "pressed", "contacts", "unit", "off_rest", with a calibration "force_n",
/// "net_force_n" and "net_torque_nmm", and, if they are known, "time_error_us" and "adopted" of a line.
[[nodiscard]] nlohmann::json to_json(const skin::LiveMonitor& monitor, const LiveState& state);

}  // namespace triskin::cli
