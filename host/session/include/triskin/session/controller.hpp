// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "triskin/layout/patch_image.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/wire/adoption.hpp"
#include "triskin/wire/calibration.hpp"
#include "triskin/wire/faults.hpp"
#include "triskin/wire/health.hpp"
#include "triskin/wire/identity.hpp"
#include "triskin/wire/lines.hpp"
#include "triskin/wire/live_taxels.hpp"
#include "triskin/wire/log.hpp"
#include "triskin/wire/offsets.hpp"
#include "triskin/wire/sampling.hpp"
#include "triskin/wire/statistics.hpp"
#include "triskin/wire/stream_account.hpp"
#include "triskin/wire/table_state.hpp"
#include "triskin/wire/topology.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::device {

/// One patch controller. Every call waits for the answer and throws Refused, NoAnswer, Unreachable, Cancelled, or
/// DeviceError when the decoder in shared/wire refuses the answer. Threads: that of the bus.
class Controller {
 public:
  /// The controller at node address `node`, 1..126; `bus` outlives it. Sends nothing.
  Controller(Bus& bus, std::uint8_t node) : bus_(bus), node_(node) {}
  [[nodiscard]] std::uint8_t node() const { return node_; }

  /// Versions, node address and unique id.
  wire::Hello hello();
  /// Throws DeviceError when the controller speaks another wire or layout version: it may only be updated.
  void require_versions(const wire::Hello& hello) const;
  /// Design id, size and CRC of the active table.
  wire::ActiveTable active_table();
  /// Bytes of the active table, `size_bytes` of them from its start. Throws DeviceError for a malformed block.
  std::vector<std::uint8_t> read_table(std::size_t size_bytes);
  /// Writes `image` into the inactive slot, lets the controller check it, and activates it. `steps` (may be empty) is
  /// called after each block with the fraction 0..1 that is written. Throws DeviceError when the table is not
  /// activated; the old one stays active then. After NoAnswer either may be active: ask active_table().
  void write_table(Bytes image, const std::function<void(double fraction)>& steps);

  /// The firmware that runs; empty: it was not started from a slot.
  std::optional<wire::ImageState> image_state();
  /// How its board is: clock, CAN, flash, stack. Empty: its firmware does not know that.
  std::optional<wire::BoardHealth> health();
  /// What stopped it last, also before its power went. Empty: nothing since its fault memory was cleared, or its
  /// firmware does not know that.
  std::optional<wire::Crash> crash();
  /// Write-protects the pages of its loader, or releases them, from its next power-up on. Throws Refused when its
  /// firmware cannot, DeviceError with the reason when its board cannot, or not yet.
  void protect_loader(bool on);
  /// Restarts the controller through its loader; returns when the request is confirmed, before the restart.
  void reset();

  /// State of each row of the table. Throws Refused without a table.
  wire::ModuleStates module_states();
  /// Scans the addresses of all lines; takes about two sample periods (75 ms).
  std::array<wire::LineReport, layout::kLines> discover();
  /// Lets the controller find modules and joints anew and route its patch; sampling pauses for up to 60 ms.
  void reroute();
  /// Modules and joints that the last search found.
  wire::FoundTopology topology();
  /// Tree over which the modules are read now.
  wire::ActiveRoute route();
  /// What it does not reach, and which modules of other patches it reads; nothing of both from an older firmware.
  wire::Adoption adoption();
  /// State and number of recoveries of each line.
  wire::LineStates line_states();
  /// Counters since the controller started.
  wire::Statistics statistics();
  /// Faults that are there or were there. Throws DeviceError for a malformed list.
  wire::FaultList faults();
  /// Deletes the fault memory.
  void clear_faults();
  /// Offsets of the converters, by row of the table.
  wire::Offsets offsets();
  /// Lets the controller search all offsets anew; returns when it has them. Takes about 1 s.
  wire::Offsets search_offsets();
  /// The calibration that it keeps with its table; empty: none, or its firmware cannot keep one.
  std::optional<wire::Calibration> calibration();
  /// Keeps a calibration with its table, or, of one without modules, deletes it. False: refused, because the firmware
  /// cannot keep one or the table is of another design or other modules; what it kept stays.
  [[nodiscard]] bool set_calibration(const wire::Calibration& calibration);
  /// The latest sample of all modules, by row of the table.
  wire::LiveTaxels taxels();
  /// How the controller samples.
  wire::SamplingSetting sampling();
  /// Lets it sample so until it is set anew or loses power. Sampling begins anew when the decimation or every n-th
  /// sequence changes, for all readers.
  void set_sampling(const wire::SamplingSetting& setting);
  /// What became of each module's samples, and who reads them over this link. Throws DeviceError naming the remedy when
  /// the firmware is too old to say so.
  wire::StreamAccount stream_account();
  /// Lets it send its log over this link, up to `level` and from the oldest line that it has, until it starts anew or
  /// kOff is set.
  void set_log(wire::LogLevel level);
  /// The level that is sent over this link, and the most that its firmware has.
  wire::LogSetting log();
  /// Switches the data stream on or off, for all readers of the link and without a lease.
  void set_stream(wire::StreamMode mode);

 private:
  using Message = Bus::Message;
  Message read(std::uint16_t did);
  /// Value of an identifier by its type.
  template <class Value>
  Value value(const char* what);
  /// Writes an identifier by its type, in a session that allows it.
  template <class Value>
  void write(const Value& value);
  /// Starts a routine and asks for its result until it is done.
  template <class Value>
  Value run_routine(std::uint64_t poll_every_us, int polls, const char* what);
  void unlock(wire::Session session);
  void end_transfer();
  [[noreturn]] void malformed(const char* what) const;

  Bus& bus_;
  std::uint8_t node_;
};

/// Name of a status that came over the wire.
[[nodiscard]] std::string describe(Status status);
/// Unique id as 24 hexadecimal digits, as `triskin discover` shows it.
[[nodiscard]] std::string to_text(const wire::UniqueId& id);
/// The unique id that such a text shows; digits that it lacks are 0. Throws std::invalid_argument for other characters.
[[nodiscard]] wire::UniqueId to_unique_id(const std::string& text);
/// Unique id, as text, of the controller that claims a node address; empty: none of them does. Cost: linear.
[[nodiscard]] std::string serial_at(std::span<const wire::NodeClaim> claims, int node);

}  // namespace triskin::device
