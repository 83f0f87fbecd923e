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
#include "triskin/wire/settled_rest.hpp"
#include "triskin/wire/statistics.hpp"
#include "triskin/wire/stream_account.hpp"
#include "triskin/wire/table_state.hpp"
#include "triskin/wire/topology.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::session {

/// A controller object talks to one patch controller. Every call waits for the answer and throws Refused, NoAnswer,
/// Unreachable, Cancelled, or DeviceError when the decoder in shared/wire rejects the answer. Use it in the thread of
/// the bus.
class Controller {
 public:
  /// Represents the controller at node address `node`, 1..126, without sending anything; `bus` must outlive it.
  Controller(Bus& bus, std::uint8_t node) : bus_(bus), node_(node) {}
  [[nodiscard]] std::uint8_t node() const { return node_; }

  /// Reads versions, node address and unique id.
  wire::Hello hello();
  /// Throws DeviceError when the controller has another wire or layout version, because it may then only be updated.
  void require_versions(const wire::Hello& hello) const;
  /// Reads the part number of the board (F190), eight characters.
  std::string part_number();
  /// Reads design id, size and CRC of the active table.
  wire::ActiveTable active_table();
  /// Reads the first `size_bytes` bytes of the active table. Throws DeviceError for a malformed block.
  std::vector<std::uint8_t> read_table(std::size_t size_bytes);
  /// Writes `image` into the inactive slot, lets the controller check it, and activates it. `steps` (may be empty) is
  /// called after each block with the fraction 0..1 that is written. Throws DeviceError when the table is not
  /// activated; the old one then stays active. After NoAnswer either table may be active, so read active_table().
  void write_table(Bytes image, const std::function<void(double fraction)>& steps);

  /// Reads which firmware runs; empty if it was not started from a slot.
  std::optional<wire::ImageState> image_state();
  /// Reads the health of the board: clock, CAN, flash, stack. Empty if the firmware does not support it.
  std::optional<wire::BoardHealth> health();
  /// Reads the cause of the last crash, even from before a power failure. Empty if there was none since the fault
  /// memory was cleared, or if the firmware does not support it.
  std::optional<wire::Crash> crash();
  /// Write-protects the pages of the loader, or releases them, from the next power-up on. Throws Refused when the
  /// firmware cannot do this, and DeviceError with the reason when the board cannot, or not yet.
  void protect_loader(bool on);
  /// Restarts the controller through its loader; returns when the request is confirmed, before the restart.
  void reset();

  /// Reads the state of each row of the table. Throws Refused without a table.
  wire::ModuleStates module_states();
  /// Scans the addresses of all lines; takes about two sample periods (75 ms).
  std::array<wire::LineReport, layout::kLines> discover();
  /// Lets the controller search for modules and joints again and route its patch; sampling pauses for up to 60 ms.
  void reroute();
  /// Reads the modules and joints that the last search found.
  wire::FoundTopology topology();
  /// Reads the tree over which the modules are read now.
  wire::ActiveRoute route();
  /// Reads which modules the controller cannot reach, and which modules of other patches it reads; both are empty with
  /// an older firmware.
  wire::Adoption adoption();
  /// Reads the state and the number of recoveries of each line.
  wire::LineStates line_states();
  /// Reads the counters, which start when the controller starts.
  wire::Statistics statistics();
  /// Reads present and past faults. Throws DeviceError for a malformed list.
  wire::FaultList faults();
  void clear_faults();
  /// Reads the offsets of the converters, by row of the table.
  wire::Offsets offsets();
  /// Reads what each taxel read when its offset was settled, by row of the table.
  wire::SettledRest settled_rest();
  /// Lets the controller search all offsets again; returns when it has them. Takes about 1 s.
  wire::Offsets search_offsets();
  /// Reads the calibration stored with the table; empty if there is none, or if the firmware cannot store one.
  std::optional<wire::Calibration> calibration();
  /// Stores a calibration with the table; one without modules deletes it. Returns false if the controller refuses,
  /// because its firmware cannot store one or its table is of another design or other modules; the stored calibration
  /// then stays.
  [[nodiscard]] bool set_calibration(const wire::Calibration& calibration);
  /// Reads the latest sample of all modules, by row of the table.
  wire::LiveTaxels taxels();
  /// Reads how the controller samples.
  wire::SamplingSetting sampling();
  /// Sets how the controller samples until the next change or power-down. If the decimation or every n-th sequence
  /// changes, sampling restarts for all readers.
  void set_sampling(const wire::SamplingSetting& setting);
  /// Reads what happened to each module's samples, and who reads them over this link. Throws DeviceError naming the
  /// remedy when the firmware is too old for this.
  wire::StreamAccount stream_account();
  /// Makes the controller send its log over this link, up to `level` and from its oldest line on, until it restarts or
  /// kOff is set.
  void set_log(wire::LogLevel level);
  /// Reads the level that is sent over this link, and the highest level that the firmware contains.
  wire::LogSetting log();
  /// Switches the data stream on or off for all readers of the link, without a lease.
  void set_stream(wire::StreamMode mode);

 private:
  using Message = Bus::Message;
  Message read(std::uint16_t did);
  /// Reads an identifier, which the type determines.
  template <class Value>
  Value value(const char* what);
  /// Writes an identifier, which the type determines, in a session that allows it.
  template <class Value>
  void write(const Value& value);
  /// Starts a routine and polls for its result until it is done.
  template <class Value>
  Value run_routine(std::uint64_t poll_every_us, int polls, const char* what);
  void unlock(wire::Session session);
  void end_transfer();
  [[noreturn]] void malformed(const char* what) const;

  Bus& bus_;
  std::uint8_t node_;
};

/// Returns the text for a status that came over the wire.
[[nodiscard]] std::string describe(Status status);
/// Formats a unique id as 24 hexadecimal digits, as `triskin discover` shows it.
[[nodiscard]] std::string to_text(const wire::UniqueId& id);
/// Parses such a text; missing digits are 0. Throws std::invalid_argument for other characters.
[[nodiscard]] wire::UniqueId to_unique_id(const std::string& text);
/// Returns the unique id, as text, of the controller that claims a node address; empty if none does. Cost: linear.
[[nodiscard]] std::string serial_at(std::span<const wire::NodeClaim> claims, int node);

}  // namespace triskin::session
