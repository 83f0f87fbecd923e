// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "triskin/layout/patch_image.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/wire/faults.hpp"
#include "triskin/wire/identity.hpp"
#include "triskin/wire/lines.hpp"
#include "triskin/wire/live_taxels.hpp"
#include "triskin/wire/statistics.hpp"
#include "triskin/wire/table_state.hpp"
#include "triskin/wire/topology.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::device {

/// One patch controller. Every call throws Refused, NoAnswer, or DeviceError when an answer is malformed: its decoder
/// in shared/wire refuses it.
class Controller {
 public:
  Controller(Bus& bus, std::uint8_t node) : bus_(bus), node_(node) {}
  [[nodiscard]] std::uint8_t node() const { return node_; }

  wire::Hello hello();
  /// Throws DeviceError when the controller speaks another wire or layout version: it may only be updated.
  void require_versions(const wire::Hello& hello) const;
  wire::ActiveTable active_table();
  /// The whole active image, byte by byte.
  std::vector<std::uint8_t> read_table(std::size_t size_bytes);
  /// Programming session, security access, download, check, activation. `steps` is called after each block.
  void write_table(Bytes image, const std::function<void(double fraction)>& steps);

  /// Empty: not started from a slot.
  std::optional<wire::ImageState> image_state();
  /// Through the loader; the answer comes first.
  void reset();

  /// Of each row of the table. Throws Refused without a table.
  wire::ModuleStates module_states();
  /// Asks all lines what answers; takes about two sample periods.
  std::array<wire::LineReport, layout::kLines> discover();
  /// Lets the controller look for modules and joints anew and route its patch; sampling rests up to 60 ms meanwhile.
  void reroute();
  wire::FoundTopology topology();
  wire::ActiveRoute route();
  wire::LineStates line_states();
  wire::Statistics statistics();
  /// Faults that are there or were there.
  wire::FaultList faults();
  void clear_faults();
  wire::LiveTaxels taxels();
  void set_stream(wire::StreamMode mode);

 private:
  using Message = Bus::Message;
  Message read(std::uint16_t did);
  /// Value of an identifier by its type.
  template <class Value>
  Value value(const char* what);
  /// Starts a routine and asks for its result until it is done.
  template <class Value>
  Value run_routine(std::uint64_t poll_every_us, int polls, const char* what);
  void unlock(wire::Session session);
  [[noreturn]] void malformed(const char* what) const;

  Bus& bus_;
  std::uint8_t node_;
};

/// Name of a status that came over the wire.
[[nodiscard]] std::string describe(Status status);
[[nodiscard]] std::string to_text(const wire::UniqueId& id);

}  // namespace triskin::device
