// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "triskin/layout/patch_image.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/wire/topology.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::device {

struct Hello {
  std::uint16_t wire_version = 0, layout_version = 0;
  std::uint32_t firmware_version = 0;
  std::uint8_t node_address = 0;
  wire::UniqueId unique_id{};
};

struct ActiveTable {
  bool present = false;
  std::uint32_t sequence = 0;
  std::uint64_t design_id = 0;
  std::uint32_t crc = 0;  ///< over the whole image
  int modules = 0;
};

/// What answers on one line, asked of the line itself.
struct LineReport {
  bool stuck = false;
  std::uint8_t answers = 0;   ///< bit a: CDC address 0x2C + a
  std::uint8_t wrong_id = 0;  ///< bit a
};

/// A fault that is there or was there (DTC).
struct RememberedFault {
  wire::ModuleState state = wire::ModuleState::kUnknown;
  int row = 0;  ///< module in the table
  bool present = false;
};

/// The firmware that runs, as its slot says.
struct ImageState {
  int slot = -1;
  bool confirmed = false;
  std::uint32_t sequence = 0, size_bytes = 0, record_crc = 0;
};

struct TaxelSample {
  std::uint32_t sample = 0;
  std::uint64_t device_time_us = 0;
  struct Module {
    std::uint16_t valid = 0;
    std::array<std::uint16_t, layout::kTaxelsPerModule> raw{};
  };
  std::vector<Module> modules;
};

/// One patch controller. Every call throws Refused, NoAnswer, or DeviceError when an answer makes no sense.
class Controller {
 public:
  Controller(Bus& bus, std::uint8_t node) : bus_(bus), node_(node) {}
  [[nodiscard]] std::uint8_t node() const { return node_; }

  Hello hello();
  /// Throws DeviceError when the controller speaks another wire or layout version: it may only be updated.
  void require_versions(const Hello& hello) const;
  ActiveTable active_table();
  /// The whole active image, byte by byte.
  std::vector<std::uint8_t> read_table(std::size_t size_bytes);
  /// Programming session, security access, download, check, activation. `steps` is called after each block.
  void write_table(Bytes image, const std::function<void(double fraction)>& steps);

  /// Empty: not started from a slot.
  std::optional<ImageState> image_state();
  /// Through the loader; the answer comes first.
  void reset();

  std::vector<wire::ModuleState> module_states();
  /// Asks all lines what answers; takes about two sample periods.
  std::array<LineReport, layout::kLines> discover();
  /// Lets the controller look for modules and joints anew and route its patch; sampling rests up to 60 ms meanwhile.
  void reroute();
  wire::FoundTopology topology();
  wire::ActiveRoute route();
  std::array<std::uint32_t, layout::kLines> recoveries();
  std::vector<RememberedFault> remembered_faults();
  void clear_faults();
  TaxelSample taxels();
  void set_stream(wire::StreamMode mode);

 private:
  using Message = Bus::Message;
  Message read(std::uint16_t did);
  // Starts a routine and asks until it has ended; its answer has `bytes` bytes after the state.
  Message run_routine(std::uint16_t id, std::size_t bytes, std::uint64_t poll_every_us, int polls, const char* what);
  void unlock(std::uint8_t session);
  [[noreturn]] void nonsense(const char* what) const;

  Bus& bus_;
  std::uint8_t node_;
};

/// Name of a status that came over the wire.
[[nodiscard]] std::string describe(Status status);
[[nodiscard]] std::string to_text(const wire::UniqueId& id);

}  // namespace triskin::device
